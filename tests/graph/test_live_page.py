"""The live page: what the server says, what the slider does, and what a browser shows of it."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from conftest import Rig
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from sensor_msgs.msg import JointState

from eha_interfaces.msg import ActuatorState

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
OPTIONS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
)  # fmt: skip


def serve(rig: Rig) -> str:
    page = rig.start("live_page", "port:=0")
    found = rig.wait(lambda: re.search(r"the rig is at (http://\S+)", page.output), "the page's address")
    return str(found[1])


def post(url: str, body: bytes, **headers: str) -> int:
    given = {"Content-Type": "application/json", **headers}
    try:
        with urllib.request.urlopen(urllib.request.Request(url, body, given), timeout=5) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        return error.code


def values(url: str) -> dict:
    with urllib.request.urlopen(f"{url}values", timeout=5) as answer:
        return json.load(answer)


def test_the_page_shows_the_rig_and_turns_its_leakage(rig: Rig, tmp_path: Path) -> None:
    url = serve(rig)
    assert post(f"{url}internal_leakage", b"1e-10") == 200
    rig.wait(lambda: "no simulator" in values(url)["refused"], "what is wrong", 5)
    rig.start_sim("initial_position:=0.0123", "spring_stiffness:=0.0")  # which would move the leaking piston
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: values(url).get("pressure_b"), "the rig's values", 20)
    assert post(f"{url}internal_leakage", b"1e-10") == 200
    rig.wait(lambda: states and states[-1].internal_leakage == 1e-10, "the leakage", 10)
    rig.wait(lambda: values(url)["internal_leakage"] == 1e-10 and values(url)["refused"] == "", "the leakage shown", 5)
    assert values(url)["position"] == pytest.approx(0.0123, abs=1e-6)
    assert values(url)["pressure_a"] == pytest.approx(1.05e7 + 101_325, rel=1e-3)
    assert post(f"{url}internal_leakage", b"1.0") == 200
    rig.wait(lambda: "internal_leakage" in values(url)["refused"], "the refusal", 5)
    for body, status in ((b"-1", 400), (b"NaN", 400), (b"true", 400), (b"{", 400), (b" " * 2000, 400)):
        assert post(f"{url}internal_leakage", body) == status
    assert post(f"{url}internal_leakage", b"1e-9", Origin="http://elsewhere.example") == 403
    assert post(f"{url}values", b"1e-9") == 404
    assert states[-1].internal_leakage == 1e-10


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_a_browser_shows_position_pressures_and_the_twin_s_departure(rig: Rig, tmp_path: Path) -> None:
    url = serve(rig)
    joints = rig.node.create_publisher(JointState, "joint_states", 10)
    diagnostics = rig.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
    departure = "chamber A departs by 107 times the noise since 12.5 s"
    other, stamp = "; chamber B departs by 9 times the noise since", 1795256025.443
    status = DiagnosticStatus(
        name="eha_twin",
        hardware_id=f"{rig.namespace}/eha_twin",
        level=DiagnosticStatus.WARN,
        message=f"{departure}{other} {stamp} s",
    )
    joint = JointState(name=["piston"], position=[0.0321], velocity=[0.01], effort=[123.4])
    joint.header.stamp.sec = 12
    rig.wait(lambda: joints.get_subscription_count() and diagnostics.get_subscription_count(), "the page's node")
    sent = DiagnosticArray(status=[status])

    def known() -> bool:
        joints.publish(joint)
        diagnostics.publish(sent)
        return {"position", "twin"} <= values(url).keys()

    rig.wait(known, "the values at the server")
    command = [str(BROWSER), *OPTIONS, f"--user-data-dir={tmp_path / 'profile'}", "--virtual-time-budget=1500",
               "--dump-dom", url]  # fmt: skip
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as browser:
        while browser.poll() is None:
            known()
            rig.spin(0.2)
        page = browser.stdout.read()
    assert '<dd id="position">32.100 mm</dd>' in page
    assert '<dd id="force">123.4 N</dd>' in page
    assert re.search(r'transform="translate\((32\.1|32\.0999\d*)\)"', page)
    time_of_day = time.strftime("%H:%M:%S", time.localtime(stamp))
    assert f"twin: {departure}{other} {time_of_day}.4<" in page and 'class="departs"' in page
    assert '<dd id="time">12.00 s</dd>' in page
