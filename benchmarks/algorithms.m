% Algorithms 1-3 of the paper in Octave, line by line: the peer of `benchmarks/octave.py`.
%
%     octave-cli algorithms.m WORLD PATH BEAMS RANGE SAMPLES STEPS ROUNDS
%
% WORLD is JSON, PATH is CSV with columns x and y. Printed is JSON: for each step what the five
% stages took in s (the least of some rounds), and the areas, edges and their points at the end.
% Numbers R1-R12 are the readings of the paper that semtopo/__init__.py lists. Zones are polygons as
% the package `geometry` has them: rings that NaN separates. It unites them by the Clipper library.

1;

function value = Space (), value = 0; end
function value = Passage (), value = 1; end
function value = Obstacle (), value = 2; end
function value = Free (), value = 3; end

function u = ReadMap (M_w, p)
  % Kind and label at a point: the later rectangle wins, outside is obstacle (R4).
  hit = find (p(1) >= M_w.low(:, 1) & p(1) <= M_w.high(:, 1) ...
              & p(2) >= M_w.low(:, 2) & p(2) <= M_w.high(:, 2), 1, "last");
  if isempty (hit)
    u = [Obstacle(), 0];
  else
    u = [M_w.kind(hit), M_w.label(hit)];
  end
end

function kept = Analyse (U)
  % Alg. 2, l. 8-34: rows of label, sample, occupancy, and whether an interval begins there.
  kept = zeros (0, 4);
  if U(1, 1) == Obstacle ()                                                              % l. 9
    return
  end
  for j = 2:rows (U)                                                                     % l. 10
    if U(j, 1) == Obstacle ()                                                            % l. 11
      if U(j-1, 1) == Space ()                                                           % R3
        kept(end+1, :) = [U(j-1, 2), j - 1, Obstacle(), false];                          % l. 12-14
      end
      break                                                                              % R2
    elseif (U(j, 1) == Passage ()) != (U(j-1, 1) == Passage ()) ...                      % l. 16
           || (U(j, 1) == Space () && U(j, 2) != U(j-1, 2))                              % R5
      if U(j-1, 1) == Space ()
        kept(end+1, :) = [U(j-1, 2), j - 1, Passage(), false];                           % l. 18-19
      end
      if U(j, 1) == Space ()
        kept(end+1, :) = [U(j, 2), j, Passage(), true];                                  % l. 21-22
      end
    elseif j == rows (U) && U(j, 1) == Space ()                                          % l. 25-26
      kept(end+1, :) = [U(j, 2), j, Free(), false];                                      % l. 27-28
    end
  end
end

function intervals = Intervals (U, kept, radii)
  % R6: rows of label, near, far, and whether it begins at the robot.
  intervals = zeros (0, 4);
  if U(1, 1) == Space ()
    intervals(end+1, :) = [U(1, 2), 0, radii(1), true];
  end
  for k = 1:rows (kept)
    radius = radii(kept(k, 2));
    if kept(k, 4)
      intervals(end+1, :) = [kept(k, 1), radius, radius, false];
    else
      intervals(end, 3) = radius;
    end
  end
end

function z_u = CreateZone (s_u, U_r, directions, p_r)
  % R6: the union of the strips between neighbouring beams; empty without area.
  strips = zeros (0, 2);
  for i = 1:numel (U_r)
    k = mod (i, numel (U_r)) + 1;
    ones_ = U_r{i}(U_r{i}(:, 1) == s_u, :);
    others = U_r{k}(U_r{k}(:, 1) == s_u, :);
    for a = 1:rows (ones_)
      for b = 1:rows (others)
        if ones_(a, 4) == others(b, 4) && ones_(a, 2) <= others(b, 3) ...
           && others(b, 2) <= ones_(a, 3)
          strip = [ones_(a, 2:3)' * directions(i, :); others(b, 3:-1:2)' * directions(k, :)] + p_r;
          if abs (SignedArea (strip)) > 1e-9
            strips = [strips; NaN, NaN; strip];
          end
        end
      end
    end
  end
  if isempty (strips)
    z_u = strips;
  else
    z_u = Unite (strips(2:end, :), strips(end-3:end, :));
  end
end

function z = Unite (one, other)
  z = clipPolygon (one, other, 3, "clipper", 1, 1);
end

function area = SignedArea (ring)
  x = ring(:, 1); y = ring(:, 2);
  area = sum (x .* circshift (y, -1) - circshift (x, -1) .* y) / 2;
end

function rings = Rings (zone)
  ends = [0; find(isnan (zone(:, 1))); rows(zone) + 1];
  rings = cell (numel (ends) - 1, 1);
  for k = 1:numel (rings)
    rings{k} = zone(ends(k)+1:ends(k+1)-1, :);
  end
end

function area = Area (zone)
  area = abs (sum (cellfun (@SignedArea, Rings (zone))));  % holes go the other way round
end

function [nearest, distance] = GetNearestPoint (zone, p_r)
  % R11; the robot's own place where that is inside.
  rings = Rings (zone);
  inside = false;
  nearest = p_r; distance = Inf;
  for k = 1:numel (rings)
    ring = rings{k};
    inside = xor (inside, inpolygon (p_r(1), p_r(2), ring(:, 1), ring(:, 2)));
    sides = circshift (ring, -1) - ring;
    share = sum ((p_r - ring) .* sides, 2) ./ max (sumsq (sides, 2), realmin);
    points = ring + min (max (share, 0), 1) .* sides;
    [least, at] = min (hypot (points(:, 1) - p_r(1), points(:, 2) - p_r(2)));
    if least < distance
      distance = least; nearest = points(at, :);
    end
  end
  if inside
    nearest = p_r; distance = 0;
  end
end

function [M_u, took] = ExtractSensorMap (M_w, U_s, p_r)
  % Algorithm 2: a zone for each label, empty where none is seen.
  begun = tic ();
  radii = (1:U_s.samples) * U_s.range / U_s.samples;
  directions = zeros (U_s.beams, 2);
  U_xy = cell (U_s.beams, 1);
  for i = 1:U_s.beams                                                                    % l. 2
    alpha = 2 * pi * (i - 1) / U_s.beams;                                                % l. 3, R1
    directions(i, :) = [sin(alpha), cos(alpha)];
    U = zeros (U_s.samples, 2);
    for j = 1:U_s.samples                                                                % l. 4
      U(j, :) = ReadMap (M_w, p_r + radii(j) * directions(i, :));                        % l. 5-6
    end
    U_xy{i} = U;
  end
  took = toc (begun);
  U_r = cell (U_s.beams, 1);
  for i = 1:U_s.beams                                                                    % l. 8-34
    U_r{i} = Intervals (U_xy{i}, Analyse (U_xy{i}), radii);
  end
  took(2) = toc (begun) - sum (took);
  M_u = cell (numel (M_w.labels), 1);
  S_u = unique (vertcat (U_r{:})(:, 1));                                                 % l. 36
  for s_u = S_u'                                                                         % l. 37-42
    M_u{s_u} = CreateZone (s_u, U_r, directions, p_r);
  end
  took(3) = toc (begun) - sum (took);
end

function [M_m, M_s, took] = UpdateMemoryMap (M_m, M_s, M_u, p_r)
  % Algorithm 3: edges are rows of source, target, x and y; nodes are labels in order.
  took = [0, 0];
  seen = find (! cellfun (@isempty, M_u))';
  if isempty (seen)                                                                      % R8
    return
  end
  begun = tic ();
  distances = Inf (size (M_u));
  for s_u = seen
    [~, distances(s_u)] = GetNearestPoint (M_u{s_u}, p_r);
  end
  [~, s_r] = min (distances);                                                            % l. 1-2, R7
  for s_u = seen                                                                         % l. 4-11
    if isempty (M_m{s_u})
      M_m{s_u} = M_u{s_u};
    else
      M_m{s_u} = Unite (M_m{s_u}, M_u{s_u});                                             % R12
    end
  end
  took(1) = toc (begun);
  for s_u = [s_r, seen(seen != s_r)]                                                     % l. 13-29
    if ! any (M_s.nodes == s_u)
      M_s.nodes(end+1) = s_u;
    end
    known = any (M_s.edges(:, 1) == s_r & M_s.edges(:, 2) == s_u);
    if s_u != s_r && ! known
      M_s.edges(end+1, :) = [s_r, s_u, GetNearestPoint(M_u{s_u}, p_r)];                  % R11
    end
  end
  took(2) = toc (begun) - took(1);
end

function [M_m, M_s, times] = Run (M_w, P_d, U_s)
  % Algorithm 1.
  M_m = cell (numel (M_w.labels), 1);
  M_s = struct ("nodes", [], "edges", zeros (0, 4));
  times = zeros (rows (P_d), 5);
  for k = 1:rows (P_d)
    [M_u, times(k, 1:3)] = ExtractSensorMap (M_w, U_s, P_d(k, :));
    [M_m, M_s, times(k, 4:5)] = UpdateMemoryMap (M_m, M_s, M_u, P_d(k, :));
  end
end

function M_w = ReadWorld (file)
  zones = jsondecode (fileread (file)).zones;
  [M_w.labels, ~, label] = unique ({zones.label});
  [~, kind] = ismember ({zones.kind}, {"space", "passage", "obstacle"});
  M_w.label = label(:); M_w.kind = kind(:) - 1;
  M_w.low = [zones.low]'; M_w.high = [zones.high]';
end

pkg load geometry
given = argv ();
M_w = ReadWorld (given{1});
numbers = str2double (given(3:end));
U_s = struct ("beams", numbers(1), "range", numbers(2), "samples", numbers(3));
P_d = dlmread (given{2}, ",", 1, 0)(1:numbers(4), 1:2);
times = Inf;
for k = 1:numbers(5)
  [M_m, M_s, took] = Run (M_w, P_d, U_s);
  times = min (times, took);
end
found.times = times;
found.nodes = M_w.labels(M_s.nodes);
found.areas = cellfun (@Area, M_m(M_s.nodes));
found.sources = M_w.labels(M_s.edges(:, 1));
found.targets = M_w.labels(M_s.edges(:, 2));
found.points = M_s.edges(:, 3:4);
disp (jsonencode (found));
