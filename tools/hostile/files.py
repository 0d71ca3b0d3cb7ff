"""Files of strangers: sound ones are mutated, and each must be read or refused in one line, soon, in little memory."""

from __future__ import annotations

import random
import resource
import signal
import tempfile
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from pathlib import Path

import h5py
import numpy as np
import pyarrow
import pyarrow.parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.io import savemat

from eha_core.errors import EhaError
from eha_core.parameters import load_parameters
from eha_core.recording import RecordingWriter, encode, load_topics_file, read_recording
from tools.hostile.extent import Course, Extent
from tools.hostile.row import Row

LONGEST = 20.0
"""s that a file of some kB may take, on a busy machine."""
MOST_MEMORY = 512_000
"""kB that the process may reach."""
BATCH = 10_000
"""Files that one process reads."""
MEMORY = Path("/dev/shm")
"""A file system in memory, where there is one: to write a file then takes no longer than to read it."""
SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND

TOPICS = """namespace: /left
channels:
  voltage_command: {topic: /valve/cmd, field: data}
  position: {topic: /cyl/joint_states, field: "position[0]", scale: 1.0e-3, offset: 0.0}
  pressure_a: {topic: /cyl/p_head, field: fluid_pressure, reference: absolute}
  pressure_b: {reference: gauge}
  velocity: null
"""
PARAMETERS = """eha_sim:
  ros__parameters:
    moving_mass: 9.0
    coulomb_friction:
      force: 300.0
    internal_leakage: 1.0e-12
"""
TOKENS = (
    b"\x00", b"\xff\xff\xff\xff", b"\xff" * 8, b"\x00\x00\x00\x80", b"&a ", b"*a", b"[", b"{", "\u202e".encode(),
    b"\x1b[2J",
    b"9" * 400, b"1e400", b".nan", b"-.inf", b"!!binary ", b"!!python/name:os.system ", b"\n- ", b": ", b",", b"\n",
    b"=" * 80,
    b"MSG: std_msgs/Header\n", b"float64[4294967295] x\n", b"2024-99-99", b"1:1:1:1", b"\x89MCAP0\r\n",
)  # fmt: skip


class TooLong(Exception):
    """A file was not done with in time."""


@contextmanager
def _deadline(seconds: float) -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TooLong

    former = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, former)


def mutated(content: bytes, chance: random.Random) -> bytes:
    """The bytes after one to four accidents: flips, cuts, zeros, doublings, moves, and what parsers trip over."""
    data = bytearray(content)
    for _ in range(chance.randint(1, 4)):
        if not data:
            break
        at = chance.randrange(len(data))
        length = min(chance.choice((1, 1, 2, 4, 8, 60, 600)), len(data) - at)
        kind = chance.randrange(8)
        if kind == 0:
            data[at] ^= 1 << chance.randrange(8)
        elif kind == 1:
            data[at : at + length] = chance.randbytes(length)
        elif kind == 2:
            data[at : at + length] = bytes(length)
        elif kind == 3:
            del data[at : at + length]
        elif kind == 4:
            data[at:at] = data[at : at + length] * chance.choice((1, 2, 30))
        elif kind == 5:
            data[at:at] = chance.choice(TOKENS)
        elif kind == 6:
            del data[chance.randrange(at, len(data)) :]
        else:
            other = chance.randrange(len(data))
            data[at : at + length] = data[other : other + length]
    return bytes(data)


def sound_files(folder: Path) -> dict[str, bytes]:
    """A small sound file of each kind."""
    made: dict[str, bytes] = {"topics.yaml": TOPICS.encode(), "parameters.yaml": PARAMETERS.encode()}
    for name, chunks, finished in (("finished.mcap", 4, True), ("unfinished.mcap", 2, False)):
        writer = RecordingWriter(folder / name, {"moving_mass": 9.0}, flush_period=1e9)
        for k in range(10 * chunks):
            stamp = START + k * SECOND // 100
            header = {"header": {"stamp": {"sec": stamp // SECOND, "nanosec": stamp % SECOND}}}
            joints = {**header, "name": ["piston"], "position": [k * 1e-4], "velocity": [0.1], "effort": [1.0]}
            writer.write_fields("/voltage_command", "std_msgs/msg/Float64", {"data": k * 1e-3}, stamp)
            writer.write_fields("/joint_states", "sensor_msgs/msg/JointState", joints, stamp)
            pressure = {**header, "fluid_pressure": 1e6}
            writer.write_fields("/chamber_a/pressure", "sensor_msgs/msg/FluidPressure", pressure, stamp)
            if k % 10 == 9:
                writer.flush()
        writer.close() if finished else writer.abandon()
        made[name] = (folder / name).read_bytes()
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder / "bag", version=8, storage_plugin=StoragePlugin.SQLITE3) as bag:
        connection = bag.add_connection("/voltage_command", "std_msgs/msg/Float64", typestore=store)
        for k in range(40):
            bag.write(connection, START + k * SECOND, encode("std_msgs/msg/Float64", {"data": k * 0.1}))
    made["bag.db3"] = next((folder / "bag").glob("*.db3")).read_bytes()
    time_s = np.arange(60) * 2e-3
    rows = "".join(f"{t:.4f},{np.sin(t):.6g},{np.cos(t):.6g},{1e6 + t:.6g}\n" for t in time_s)
    made["table.csv"] = f"time,voltage_command,position,pressure_a\n{rows}".encode()
    made |= log_files(folder)
    return made


def log_files(folder: Path) -> dict[str, bytes]:
    """A small log file of each kind that other libraries read."""
    time_s = np.arange(60) * 2e-3
    columns = {"time": time_s, "voltage_command": np.sin(time_s), "position": np.cos(time_s)}
    structure = {"Y": np.array([("x", time_s), ("u", time_s)], dtype=[("Name", object), ("Data", object)])}
    savemat(folder / "log.mat", {**columns, "run": structure})
    with h5py.File(folder / "log_73.mat", "w") as file:
        for name, values in columns.items():
            file.create_dataset(name, data=values.reshape(-1, 1), compression="gzip")
    pyarrow.parquet.write_table(pyarrow.table(columns), folder / "log.parquet")
    rows = "".join(f"\t{t:.4f}\t{np.cos(t):.6g}\n".replace(".", ",") for t in time_s)
    tags = "LabVIEW Measurement\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tNo\n***End_of_Header***\n"
    tags += "Channels\t2\nX0\t0,0\t0,0\nDelta_X\t0,002\t0,002\n***End_of_Header***\ntime\tvoltage_command\tposition\n"
    (folder / "log.lvm").write_text(tags + rows)
    return {name: (folder / name).read_bytes() for name in ("log.mat", "log_73.mat", "log.parquet", "log.lvm")}


READERS: dict[str, Callable[[Path], object]] = {
    "topics.yaml": load_topics_file, "parameters.yaml": load_parameters, "finished.mcap": read_recording,
    "unfinished.mcap": read_recording, "bag.db3": read_recording, "table.csv": read_recording,
    "log.lvm": read_recording, "log.mat": read_recording, "log_73.mat": read_recording, "log.parquet": read_recording,
}  # fmt: skip


def try_files(extent: Extent, seed: int) -> list[Row]:
    """Mutate and read files of each kind in turn, a batch at a time in a process of its own, which may die."""
    rows = {name: Row(f"mutated {name}", seed) for name in READERS}
    with tempfile.TemporaryDirectory(dir=MEMORY if MEMORY.is_dir() else None) as temporary:
        content = sound_files(Path(temporary))
        course, done = extent.begin(), 0
        while not course.over(done):
            for name, found in _in_its_own_process(content, Path(temporary), f"{seed} {done}", course, done).items():
                rows[name].add(found)
            done = sum(row.times for row in rows.values())
    return list(rows.values())


def _in_its_own_process(
    content: dict[str, bytes], folder: Path, seed: str, course: Course, done: int
) -> dict[str, Row]:
    """The rows of a batch; where its process died, those of the file that it died of."""
    there, here = Pipe(duplex=False)
    process = get_context("fork").Process(target=_batch, args=(content, folder, seed, course, done, here))
    process.start()
    here.close()
    try:
        rows: dict[str, Row] = there.recv()
    except EOFError:
        process.join()
        path = max(folder.glob("mutated*"), key=lambda path: path.stat().st_mtime_ns)
        rows = {name: Row(name, 0) for name in READERS if name.endswith(path.suffix)}
        next(iter(rows.values())).fail(f"the process ended with {process.exitcode}: {path.read_bytes().hex()}")
    process.join()
    return rows


def _batch(content: dict[str, bytes], folder: Path, seed: str, course: Course, done: int, answer: Connection) -> None:
    chance = random.Random(seed)
    rows = {name: Row(name, 0) for name in READERS}
    count = 0
    while count < BATCH and not course.over(done + count):
        for name, read in READERS.items():
            path = folder / f"mutated{Path(name).suffix}"
            data = mutated(content[name], chance)
            path.write_bytes(data)
            _try(rows[name], read, path, data)
        count += len(READERS)
    answer.send(rows)


def _try(row: Row, read: Callable[[Path], object], path: Path, data: bytes) -> None:
    try:
        with _deadline(LONGEST):
            result = read(path)
    except EhaError as error:
        if str(error).isprintable():
            row.count("refused in one line")
        else:
            row.fail(f"a message that is no line: {data.hex()[:200]}")
    except TooLong:
        row.fail(f"more than {LONGEST:g} s: {data.hex()}")
    except Exception:
        row.fail(f"{traceback.format_exc(limit=-3)} {data.hex()}")
    else:
        row.count("read, its damage said" if getattr(result, "damaged", None) else "read")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    if peak > MOST_MEMORY:
        row.fail(f"{peak} kB of memory after {data.hex()}")
