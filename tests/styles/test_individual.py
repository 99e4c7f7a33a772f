"""run_style sph/adaptive individual: Algorithm 1 as printed, with steps of individual particles."""

import numpy as np
import pytest
from harness import by_id, instance, last_frame, run, write
from scenes import DROP, END, MAKE_DROP, MAKE_FALL, fall


@pytest.fixture
def folder(tmp_path):
    run(write(tmp_path, MAKE_FALL, "in.make"))
    return tmp_path


def result(folder, name):
    return last_frame(folder / name)


def test_all_in_one_bin_is_the_global_scheme(folder):
    """A ceiling below every limit."""
    for scheme in ("global", "individual"):
        script = fall(scheme, ceiling=2e-4) + END
        run(write(folder, script, f"in.{scheme}"), dump=f"{scheme}.txt")
    difference = np.abs(result(folder, "global.txt") - result(folder, "individual.txt"))
    assert difference.max() < 1e-11


def test_few_are_active_and_the_updates_are_counted(folder, monkeypatch):
    monkeypatch.chdir(folder)
    lmp = instance()
    lmp.commands_string(fall("individual") + "run 0")
    updates, active, n = 0.0, [], lmp.get_natoms()
    for _ in range(60):
        lmp.command("run 1 post no")
        active.append(lmp.extract_fix("step", 0, 1, 1))
        updates += active[-1] * n
    assert min(active) < 0.7
    assert lmp.extract_fix("step", 0, 1, 2) == pytest.approx(updates, rel=1e-12)


@pytest.mark.parametrize("overdue", ["no", "yes"])
def test_updates_that_are_overdue(folder, monkeypatch, overdue):
    """(15) alone passes over particles whose step has passed; with (14) they are active."""
    monkeypatch.chdir(folder)
    lmp = instance()
    lmp.commands_string(fall("individual", limits=f"overdue {overdue}") + "run 0 post no")
    order = lambda: np.argsort(lmp.numpy.extract_atom("id")[: lmp.get_natoms()])  # noqa: E731
    waits, passed_over = [], 0
    own, last, _ = np.array(lmp.numpy.extract_fix("step", 1, 2))[order()].T[:3]
    for _ in range(100):
        lmp.command("run 1 post no")
        now = lmp.get_thermo("time")
        wait = (now - last) / own
        own, last, active = np.array(lmp.numpy.extract_fix("step", 1, 2))[order()].T[:3]
        waits.extend(wait[active == 1])
        passed_over += np.sum(wait[active == 0] > 1 + 1e-9)
    longest, mean = (lmp.extract_fix("step", 0, 1, n) for n in (31, 32))
    assert longest == pytest.approx(max(waits), rel=1e-9)
    assert mean == pytest.approx(np.sum(waits) / lmp.extract_fix("step", 0, 1, 2), rel=1e-9)
    assert (passed_over > 0) == (overdue == "no")
    assert (longest > 1.5) == (overdue == "no")


def test_inactive_particles_go_on_as_at_the_last_update(folder, monkeypatch):
    """(x, v, rho) of an inactive particle follow from its last update alone: lines 12, 31 to 33."""
    monkeypatch.chdir(folder)
    lmp = instance()
    lmp.commands_string(fall("individual") + "run 40")

    def column(k):
        order = np.argsort(lmp.numpy.extract_atom("id")[: lmp.get_natoms()])
        return np.array(lmp.numpy.extract_fix("step", 1, 2))[order][:, k]

    times, frames = [lmp.get_thermo("time")], []
    for _ in range(3):
        frames.append({name: by_id(lmp, name) for name in ("x", "v", "rho", "drho")})
        frames[-1]["rests"] = column(2) == 0
        last = column(1)
        lmp.command("run 1 post no")
        times.append(lmp.get_thermo("time"))
    rests = frames[1]["rests"] & frames[2]["rests"]
    assert 20 < rests.sum() < len(rests)
    dt = np.diff(times)
    change = [
        {name: (frames[k + 1][name] - frames[k][name])[rests] for name in ("x", "v", "rho")}
        for k in (0, 1)
    ]
    accel = change[0]["v"] / dt[0]
    assert np.abs(accel).max() > 1
    np.testing.assert_allclose(change[1]["v"], dt[1] * accel, atol=1e-12)
    rate = change[0]["rho"] / dt[0]
    assert np.abs(rate).max() > 1
    np.testing.assert_allclose(rate, frames[0]["drho"][rests], atol=1e-6)
    np.testing.assert_allclose(change[1]["rho"], dt[1] * rate, atol=1e-8)
    elapsed = (times[1] - last[rests])[:, None]
    way = dt[1] * (frames[2]["v"][rests] + elapsed * accel)
    np.testing.assert_allclose(change[1]["x"], way, atol=1e-12)
    assert np.abs(elapsed * accel).max() > 1e-4


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks(folder, ranks):
    script = fall("individual") + END
    run(write(folder, script), dump="one.txt", steps=100)
    run(write(folder, script), ranks=ranks, dump="many.txt", steps=100)
    assert np.abs(result(folder, "one.txt") - result(folder, "many.txt")).max() < 1e-9


def test_restart_and_split_runs_in_the_middle_of_a_hierarchy(folder):
    begin = fall("individual")
    write_all = END.replace("run ${steps}", "")
    run(
        write(folder, begin + "run 60\nwrite_restart half.bin\nrun 60\n" + write_all, "in.split"),
        dump="split.txt",
    )
    run(write(folder, begin + END, "in.whole"), dump="whole.txt", steps=120)
    after = begin.replace("read_data fall.data", "read_restart half.bin")
    after = after.replace("pair_style sph/tait 0.1\n", "").replace(
        "pair_coeff 1 1 fluid 1000 c0 20 alpha 0.1\n", ""
    )
    run(write(folder, after + END, "in.again"), dump="again.txt", steps=60)
    whole, split, again = (result(folder, f"{n}.txt") for n in ("whole", "split", "again"))
    assert np.array_equal(split, again)
    assert np.abs(whole - split).max() < 1e-9


def test_a_run_with_another_scheme_behind_it_updates_all(folder, monkeypatch):
    monkeypatch.chdir(folder)
    lmp = instance()
    lmp.commands_string(fall("individual") + "run 40")
    assert lmp.extract_fix("step", 0, 1, 1) < 1
    lmp.commands_string("run_style sph/adaptive global\nrun 5")
    assert lmp.extract_fix("step", 0, 1, 1) == 1


def test_with_cloth_and_contact_nothing_passes(tmp_path):
    run(write(tmp_path, MAKE_DROP, "in.make"))
    script = DROP + "run_style sph/adaptive individual\n" + END
    out = run(write(tmp_path, script), ranks=2, dump="end.txt", steps=200)
    assert "steps by limit" in out
    assert np.isfinite(last_frame(tmp_path / "end.txt")).all()


def test_an_integrated_density_is_an_error(folder, monkeypatch):
    monkeypatch.chdir(folder)
    script = fall("individual").replace("sph/tait 0.1", "sph/tait 0.1 density continuity")
    with pytest.raises(Exception, match=r"need densities by summation.*'density summation'.* than"):
        instance().commands_string(script + "run 1")
