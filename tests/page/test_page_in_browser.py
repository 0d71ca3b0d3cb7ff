"""From a stranger's CSV to a named effect with the mouse, in a real browser."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from chromium import PROGRAM, Chromium
from test_page_server import BAG, Server

from eha_core.recording import read_recording

SECONDS = 6.0
"""Of the run that is logged: enough to name its friction, and half the time."""


def strange_log(path: Path) -> None:
    """The bag as a logger that nobody described would write it: counts, %, mA, a turned encoder, a clock in ms."""
    channels = read_recording(BAG).channels
    time = np.arange(0.0, SECONDS, 0.002)
    values = {name: np.interp(time, one.time, one.values) for name, one in channels.items()}
    columns = {
        "Stamp [ms]": 1e3 * time + 417.0,
        "Y1": 10.0 * values["voltage_command"],
        "enc": -values["position"] * 1e6,
        "P_head [mA]": 4.0 + 16.0 * values["pressure_a"] / 250e5,
        "P_rod [mA]": 4.0 + 16.0 * values["pressure_b"] / 250e5,
        "T_oil [°C]": 41.0 + 0.01 * time,
    }
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, delimiter=";")
        writer.writerow(columns)
        writer.writerows([f"{value:.9g}" for value in row] for row in zip(*columns.values(), strict=True))


def say(browser: Chromium, column: str, channel: str, unit: str = "", points: tuple[float, ...] = ()) -> None:
    """Choose what a column is, as a person does: its channel, its unit, and two points of its sensor."""
    browser.fill(f'[aria-label="channel of {column}"]', channel)
    if unit:
        browser.fill(f'[aria-label="unit of {channel}"]', unit)
    if not points:
        return
    if not browser.value(f"rows.find((row) => row.channel === '{channel}').points.length"):
        browser.click(f'[aria-label="two points of {channel}"]')
    for k in (0, 1):
        browser.fill(f'[aria-label="{channel} recorded {k + 1}"]', str(points[2 * k]))
        browser.fill(f'[aria-label="{channel} means {k + 1}"]', str(points[2 * k + 1]))


@pytest.mark.skipif(PROGRAM is None, reason="no Chromium is installed")
@pytest.mark.timeout(900)
def test_a_stranger_s_log_is_mapped_with_the_mouse_and_its_friction_named(tmp_path: Path) -> None:
    log = tmp_path / "strange.csv"
    strange_log(log)
    server = Server(tmp_path)
    try:
        with Chromium(tmp_path / "profile") as browser:
            browser.open(server.url)
            browser.wait("choices !== undefined")
            assert "Drop a recording here" in browser.text("#drop")
            browser.drop("#file", log)
            browser.wait("file && file.name === 'strange.csv'")
            assert browser.value("document.querySelectorAll('svg.outline path').length") == 6
            assert browser.value("at('start').disabled") and "Still open" in browser.text("#open-points")
            say(browser, "Y1", "voltage_command", "V", (0, 0, 100, 10))
            say(browser, "enc", "position", "mm", (0, 0, 1000, 1))
            browser.click('[aria-label="turned of position"]')
            say(browser, "P_head [mA]", "pressure_a", "bar", (4, 0, 20, 250))
            say(browser, "P_rod [mA]", "pressure_b", "bar", (4, 0, 20, 250))
            assert browser.text("#open-points") == "" and not browser.value("at('start').disabled")
            browser.click("#start")
            browser.wait("!at('result-step').hidden || at('open-points').textContent !== ''", 800)
            assert browser.text("#open-points") == ""
            assert "the seals rub" in browser.text("#account")
            assert "coulomb_friction" in browser.text("#account")
            assert "the catalogue's cylinder is assumed" in browser.text("#warnings")
            assert {"topics.yaml", "report.html", "fitted.yaml"} <= set(browser.text("#downloads").split())
            # in a frame of its own, which cannot reach the page
            browser.wait("at('report').contentDocument === null")
        folder = tmp_path / "out" / "strange"
        found = json.loads((folder / "diagnosis.json").read_text())
        assert [effect["id"] for effect in found["effects"]] == ["coulomb_friction"]
        force = found["effects"][0]["parameters"]["force"]
        assert abs(force["value"] - 250.0) < 5.0 * force["std"]
        channels, original = read_recording(log, folder / "topics.yaml").channels, read_recording(BAG).channels
        for name, one in channels.items():
            there = np.interp(one.time, original[name].time, original[name].values)
            np.testing.assert_allclose(one.values, there, rtol=1e-6, atol=1e-8)
        status, report, headers = server.ask("report")
        assert status == 200 and b"dry friction" in report
        assert headers["content-security-policy"].startswith("sandbox allow-scripts")
        status, topics, headers = server.ask("download/topics.yaml")
        assert topics == (folder / "topics.yaml").read_bytes() and "attachment" in headers["content-disposition"]
    finally:
        server.end()
