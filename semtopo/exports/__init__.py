"""Write a map for other programs: each format in a file of its own, as bytes.

In come values; out go documents that the programs' own readers take. The same map gives the same
bytes. Lengths are in m, map frame.
"""
