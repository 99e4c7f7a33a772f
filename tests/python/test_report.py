"""The page holds what was found, survives hostile input, and works in a real browser."""

from __future__ import annotations

import base64
import json
import math
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import dump_frame
from typer.testing import CliRunner

from sphcloth.cli import app
from sphcloth.errors import UserError
from sphcloth.report import viewer

EVIL = "</script><script>document.title='broken'</script><img src=x onerror=alert(1)>"
DOT = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de"
    "0000000c4944415408d763f8cfc0000003010100c9fe92ef0000000049454e44ae426082"
)


def metric(value: float | None, limit: float | None, passed: bool | None) -> dict:
    return {"value": value, "limit": limit, "unit": "m", "passed": passed}


def validation(case: str, passed: bool = True) -> dict:
    metrics = {"error": metric(0.0123456, 0.02, passed), "order": metric(None, None, None)}
    return {
        "case": case,
        "metrics": metrics,
        "passed": passed,
        "parameters": {"n": 3},
        "wall_s": 1.5,
    }


def write(folder: Path, name: str, values: object) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(values if isinstance(values, str) else json.dumps(values))
    return folder / name


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """A folder with a result of every kind, two of them hostile, and a dump."""
    folder = tmp_path / "results"
    write(folder / "a", "jet.json", validation("jet"))
    (folder / "a" / "jet.png").write_bytes(DOT)
    write(folder / "b", "evil.json", validation(EVIL, passed=False))
    write(folder / "b", "out.json", validation("../a/jet"))
    best = {"overall": "global", "by_scheme": {"global": {"values": {"acoustic": "0.5"}}}}
    quantities = [{"name": "../../a/jet"}, {"name": "kinetic"}, "nonsense"]
    study = {"scene": "pool", "points": [], "quantities": quantities, "error": 0.01}
    write(folder / "c", "pool.json", study | {"best": {"updates": best, "wall_s": EVIL}})
    (folder / "c" / "pool-kinetic.png").write_bytes(DOT)
    spread = {"value": 1.5, "least": 1.25, "most": 2.0}
    write(folder, "pair.json", {"bench": "pair", "ratio": spread, "deep": {"inner": {"x": EVIL}}})
    fact = {"topic": "contact", "measured": "contacts = 0", "line": "# fix contact"}
    write(folder, "advice.json", {"script": "in.x", "facts": [fact, 3], "needs": [], "unused": []})
    write(folder, "broken.json", '{"case": "half')
    write(folder, "other.json", [1, 2, 3])
    write(folder, "deep.json", "[" * 100_000)
    frames = []
    for step in range(5):
        turn = 0.2 * step
        rows = [
            [n + 1, 1, math.cos(n + turn), math.sin(n + turn), 0.1 * n, -n, 0.5 * n, 0]
            for n in range(30)
        ]
        frames.append(dump_frame(step, rows, "id type x y z vx vy vz"))
    write(folder / "run", "turn.lammpstrj", "".join(frames))
    return folder


def make(folder: Path, out: Path, *more: str) -> str:
    done = CliRunner().invoke(app, ["report", str(folder), "--out", str(out), *more])
    assert done.exit_code == 0, f"{done.output}{done.exception}"
    return out.read_text()


def test_each_result_is_on_the_page(results: Path, tmp_path: Path) -> None:
    page = make(results, tmp_path / "page.html", "--title", "Wet & dry")
    assert "<h1>Wet &amp; dry</h1>" in page
    assert "2 of 3</span> cases within all their limits" in page
    assert "0.01235" in page and "0.02" in page
    assert '1.5 <span class="soft">(1.25 to 2)</span>' in page
    assert "acoustic = 0.5" in page and "<code># fix contact</code>" in page
    assert page.count("data:image/png;base64,") == 2, "the way out of the folder is not followed"
    for broken in ("broken.json", "deep.json"):
        assert broken in page
    assert "other.json" not in page


def test_a_name_in_brackets_is_no_markup(
    results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["report", str(results), "--out", "[/r].html"])
    assert done.exit_code == 0 and "[/r].html: " in done.output


def test_nothing_is_fetched_and_no_text_is_code(results: Path, tmp_path: Path) -> None:
    page = make(results, tmp_path / "page.html")
    assert EVIL not in page and "<img src=x" not in page
    assert "&lt;/script&gt;&lt;script&gt;" in page
    assert not re.search(r"""(src|href)=["'](?!data:|\#)""", page)
    assert "http:" not in page and "https:" not in page
    assert "default-src 'none'" in page


def test_the_names_in_a_dump_cannot_leave_the_data(results: Path, tmp_path: Path) -> None:
    shutil.copy(results / "run/turn.lammpstrj", results / "run/<b>.lammpstrj")
    page = make(results, tmp_path / "page.html")
    assert "<b>.lammpstrj" not in page and "&lt;b&gt;.lammpstrj" in page


def test_numbers_of_a_packed_trajectory(results: Path) -> None:
    packed = viewer.pack(results / "run/turn.lammpstrj")
    assert packed.caption == "5 of 5 frames"
    frame = packed.data["frames"][2]
    water = np.frombuffer(base64.b64decode(frame["water"]), "<u2").reshape(-1, 3)
    low, size = np.array(packed.data["low"]), packed.data["size"]
    exact = [[math.cos(n + 0.4), math.sin(n + 0.4), 0.1 * n] for n in range(30)]
    np.testing.assert_allclose(low + size * water / 65535, exact, atol=size / 65535)
    speed = np.frombuffer(base64.b64decode(frame["speed"]), np.uint8)
    np.testing.assert_allclose(speed, 255 * np.arange(30) / 29, atol=0.51)


def test_a_large_dump_is_thinned(results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viewer, "PARTICLES", 12)
    monkeypatch.setattr(viewer, "FRAMES", 3)
    packed = viewer.pack(results / "run/turn.lammpstrj")
    assert packed.caption == "3 of 5 frames, every 3rd particle"
    assert len(packed.data["frames"]) == 3
    assert len(packed.data["frames"][0]["water"]) == 4 * 10 * 3 * 2 // 3  # base64 of 10 places


def test_nothing_to_show_is_an_error(tmp_path: Path) -> None:
    write(tmp_path / "empty", "broken.json", "{")
    for folder, message in ((tmp_path / "empty", "no results in"), (tmp_path / "no", "no folder")):
        done = CliRunner().invoke(app, ["report", str(folder), "--out", str(tmp_path / "x.html")])
        assert isinstance(done.exception, UserError) and message in str(done.exception)
    assert not (tmp_path / "x.html").exists()


def test_a_page_replaces_nothing_but_a_page(results: Path, tmp_path: Path) -> None:
    log = write(tmp_path, "log.lammps", "Step\n")
    done = CliRunner().invoke(app, ["report", str(results), "--out", str(log)])
    assert isinstance(done.exception, UserError) and "is there and is no HTML" in str(
        done.exception
    )
    assert log.read_text() == "Step\n"
    first = make(results, tmp_path / "page.html", "--title", "first")
    assert make(results, tmp_path / "page.html", "--title", "second") != first


def test_a_dump_that_cannot_be_read_is_left_out(results: Path, tmp_path: Path) -> None:
    write(results, "bad.lammpstrj", "ITEM: NOTHING\n")
    steps = [dump_frame(n, [[1, 1, math.nan if n == 7 else n, 0, 0]]) for n in range(20)]
    write(results, "lost.lammpstrj", "".join(steps))
    page = make(results, tmp_path / "page.html")
    assert "lost.lammpstrj" in page and "NaN" not in page
    assert "bad.lammpstrj" in page and "expected &#x27;ITEM: TIMESTEP&#x27;" in page


# in a browser


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator:
    """Chromium without a window; the test is skipped where there is none."""
    programs = [shutil.which(name) for name in ("chromium", "chromedriver")]
    if not all(programs):
        pytest.skip("no browser: apt-get install chromium chromium-driver")
    webdriver = pytest.importorskip(
        "selenium.webdriver", reason="no selenium: pip install selenium"
    )
    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    folder = tmp_path_factory.mktemp("profile")
    for switch in (
        "headless",
        "no-sandbox",
        "disable-gpu",
        "disable-quic",
        "no-first-run",
        "disable-background-networking",
        "disable-component-update",
        "disable-sync",
        "window-size=1200,1000",
        f"user-data-dir={folder}",
    ):
        options.add_argument(f"--{switch}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(programs[1]))
    yield driver
    driver.quit()


def test_the_page_in_a_browser(browser, results: Path, tmp_path: Path) -> None:
    from selenium.webdriver import ActionChains, Keys
    from selenium.webdriver.support.ui import WebDriverWait

    make(results, tmp_path / "page.html", "--title", "In a browser")
    browser.get((tmp_path / "page.html").as_uri())

    def find(name: str):
        return browser.find_element("css selector", name)

    def state(name: str) -> str:
        return find("canvas").get_attribute(f"data-{name}")

    def wait(condition, what: str) -> None:
        WebDriverWait(browser, 300, 0.05).until(lambda _: condition(), what)

    def picture() -> str:
        return browser.execute_script("return arguments[0].toDataURL()", find("canvas"))

    wait(lambda: state("frame") == "4", "the last frame is drawn")
    assert browser.title == "In a browser"
    colors = browser.execute_script(
        "const c = arguments[0], d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let blue = 0; for (let i = 0; i < d.length; i += 4) blue += d[i + 2] > d[i] + 60;"
        "return blue",
        find("canvas"),
    )
    assert colors > 500, "no water in the picture"
    before, yaw, pitch = picture(), state("yaw"), state("pitch")
    ActionChains(browser).click_and_hold(find("canvas")).move_by_offset(120, 40).release().perform()
    wait(lambda: state("yaw") != yaw and state("pitch") != pitch, "dragging turns the scene")
    assert picture() != before
    find(".reset").click()
    wait(lambda: state("yaw") == yaw and picture() == before, "reset shows the same again")
    near = float(state("distance"))
    ActionChains(browser).scroll_from_origin(_over(find("canvas")), 0, -400).perform()
    wait(lambda: float(state("distance")) < near, "the wheel zooms")
    find("input[type=range]").send_keys(Keys.HOME)
    wait(lambda: state("frame") == "0", "the slider goes to the first frame")
    assert find(".label").text == "step 0"
    find(".play").click()
    wait(lambda: int(state("frame")) > 1, "the film plays")
    find(".play").click()
    assert find(".play").text == "Play"
    find("summary").click()
    wait(lambda: find("details img").is_displayed(), "a case opens")
    images = browser.find_elements("css selector", "img")
    assert len(images) == 2
    said = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not said, "the page reports errors"
    loaded = browser.execute_script(
        "return performance.getEntriesByType('resource').map(e => e.name)"
    )
    assert all(name.startswith("data:") for name in loaded)


def _over(element):
    from selenium.webdriver.common.actions.wheel_input import ScrollOrigin

    return ScrollOrigin.from_element(element)
