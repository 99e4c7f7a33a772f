"""Plots of a run's history."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from sphcloth.log import ThermoTable
from sphcloth.plots import active_share, draw_active_share, plot_history

COLUMNS = {
    "Step": [0, 10, 20, 30],
    "Time": [0.0, 0.1, 0.2, 0.3],
    "Dt": [0.01, 0.01, 0.01, 0.01],
    "v_fluid": [0, 0, 100, 100],
    "v_updates": [0, 0, 500, 1500],
    "v_deviation": [0.0, 0.0, 0.01, 0.01],
}


def table(**changes):
    columns = COLUMNS | changes
    return ThermoTable({name: np.array(c, dtype=float) for name, c in columns.items()}, 1.0)


def test_the_active_share_is_a_mean_over_the_steps_from_row_to_row():
    np.testing.assert_allclose(active_share(table()), [np.nan, 0.5, 1.0])
    without = {name: column for name, column in table().columns.items() if name != "v_updates"}
    assert active_share(ThermoTable(without, 1.0)) is None


@pytest.mark.parametrize(("updates", "axes"), [([0, 0, 500, 1500], 2), ([0, 0, 1000, 2000], 1)])
def test_it_is_drawn_only_where_some_rest(tmp_path, updates, axes):
    figure = Figure()
    draw_active_share(figure.subplots(), table(v_updates=updates))
    assert len(figure.axes) == axes
    plot_history(table(v_updates=updates), tmp_path / "history.png")
    assert (tmp_path / "history.png").stat().st_size > 1000
