"""Measure: ratios within one run, on the machine where they are run."""
