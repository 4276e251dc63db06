"""Which fraction of a terrain's peaks is on a lattice: against peaks that were put there."""

import numpy as np

from playground.course.measures import Grid, peaks_on_lattice


def test_peak_counts_if_row_and_column_are_on_lattice():
    values = np.zeros((17, 17))
    for row, column in ((4, 8), (6, 2), (9, 4), (4, 11), (13, 13)):
        values[row, column] = 1.0
    assert peaks_on_lattice(values, Grid(), 2) == 2 / 5
    assert peaks_on_lattice(values, Grid(), 4) == 1 / 5
    assert peaks_on_lattice(values, Grid(), 1) == 1.0


def test_what_is_no_peak_does_not_count():
    values = np.zeros((9, 9))
    values[4, 4:6] = 1.0  # two texels alike
    values[0, 2] = 2.0  # at the border
    assert peaks_on_lattice(values, Grid(), 2) == 0.0
