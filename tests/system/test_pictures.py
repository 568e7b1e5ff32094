"""Pictures of whole runs: the live ones are those from the log, whoever draws them; and what goes wrong is one line."""
import re
import os
import pathlib
import shutil
import struct
import subprocess
import zlib

import pytest

import labrun as lab

LOOKS = ("--set", "renderer.enabled=true", "--set", "renderer.fps=8", "--set", "renderer.size=[160,120]", "--set", "renderer.ghost=4",
         "--set", "renderer.trace=end_effector", "--set", "renderer.reference=true", "--set", "renderer.orbit=0.4", "--set", "renderer.quality=fine")


def render(*words, before=()):
    return subprocess.run([*before, lab.LAB, "render", *map(str, words)], env=lab.environment(), capture_output=True, text=True, timeout=lab.DEADLINE,
                          stdin=subprocess.DEVNULL)


def read_png(path):
    """(width, height, texts) of a PNG file, every chunk's sum checked: no library of ours."""
    raw = path.read_bytes()
    assert raw[:8] == b"\x89PNG\r\n\x1a\n"
    at, texts, pixels = 8, {}, b""
    while at < len(raw):
        size, kind = struct.unpack_from(">I4s", raw, at)
        data = raw[at + 8:at + 8 + size]
        assert struct.unpack_from(">I", raw, at + 8 + size)[0] == zlib.crc32(kind + data)
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack_from(">IIBB", data)
        elif kind == b"tEXt":
            key, value = data.split(b"\0", 1)
            texts[key.decode()] = value.decode("latin-1")
        elif kind == b"IDAT":
            pixels += data
        at += 12 + size
    assert kind == b"IEND" and len(zlib.decompress(pixels)) == height * (1 + width * {(8, 2): 3, (16, 0): 2}[bits, colour])
    return width, height, texts


def files(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}


def no_halves(folder):
    return [p.name for p in folder.rglob("*") if p.name.endswith(".part")]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A live run with everything drawn that can be."""
    folder = tmp_path_factory.mktemp("pictures")
    done = lab.run(lab.experiment(folder, duration=2.0), folder / "run", *LOOKS)
    assert done.returncode == 0, done.stderr
    return folder / "run"


def test_live_pictures_are_those_of_the_log_for_any_number_of_workers(run, tmp_path):
    live = files(run / "frames")
    assert sorted(live) == [f"{i:04}.png" for i in range(17)]
    for workers in (1, 2, 4):
        out = tmp_path / str(workers)
        done = render(run, "-j", workers, "-o", out)
        assert done.returncode == 0, done.stderr
        assert done.stdout.split() == [f"{out}/{name}" for name in [*sorted(live), "contact.png", "ghost.png"]]
        drawn = files(out)
        assert drawn.pop("contact.png") == (run / "contact.png").read_bytes()
        assert drawn.pop("ghost.png") == (run / "ghost.png").read_bytes()
        assert drawn == live


def test_texts_say_run_step_time_and_camera(run):
    gl = (run / "gl.txt").read_text().strip()
    runs = set()
    for i in range(17):
        width, height, texts = read_png(run / "frames" / f"{i:04}.png")
        assert (width, height) == (160, 120)
        assert texts["step"] == str(25 * i) and texts["time"] == f"{0.125 * i:.6f} s" and texts["renderer"] == gl
        assert re.fullmatch(r"iso; eye( \S+){3} target( \S+){3} up( \S+){3} m; fov \S+ rad", texts["camera"])
        runs.add(texts["run"])
    _, data = next(e for e in lab.events(run / "log.lcm") if e[0] == "RUN")
    assert runs == {f"{lab.header(data)[1] & (2**64 - 1):016x}"}


def test_frames_are_told_when_they_are_written(run, tmp_path):
    types = lab.generated_types(tmp_path)
    told = [types.frame_t.decode(data) for channel, data in lab.events(run / "telemetry.lcm") if channel == "FRAME"]
    assert [(f.step, f.path, f.width, f.height) for f in told] == [(25 * i, f"frames/{i:04}.png", 160, 120) for i in range(17)]


def test_single_times_and_overviews(run, tmp_path):
    assert render(run, "--times", "0.5,1.25", "-o", tmp_path / "a").returncode == 0
    assert (tmp_path / "a" / "0001.png").read_bytes() == (run / "frames" / "0010.png").read_bytes()
    assert sorted(files(tmp_path / "a")) == ["0000.png", "0001.png", "contact.png"]
    assert render(run, "--ghost", 4, "--contact", 6, "-o", tmp_path / "b").returncode == 0
    assert sorted(files(tmp_path / "b")) == ["contact.png", "ghost.png"]
    assert (tmp_path / "b" / "ghost.png").read_bytes() == (run / "ghost.png").read_bytes()
    width, height, _ = read_png(tmp_path / "b" / "contact.png")
    assert width >= 3 * 160 and height >= 2 * 120  # six, three in a row
    assert width < 4 * 160 and height < 3 * 120
    assert render(run, "--times", "1", "--camera", "side", "-o", tmp_path / "c").returncode == 0
    assert read_png(tmp_path / "c" / "0000.png")[2]["camera"].startswith("side; ")


def test_depths_and_ids(run, tmp_path):
    done = render(run, "--times", "1", "--depth", "--ids", "-o", tmp_path)
    assert done.returncode == 0, done.stderr
    assert sorted(files(tmp_path)) == ["0000.depth.f32", "0000.depth.png", "0000.id.png", "0000.png"]
    assert len(files(tmp_path)["0000.depth.f32"]) == 4 * 160 * 120
    assert read_png(tmp_path / "0000.depth.png")[2]["unit"].startswith("0.001 m")
    assert re.match(r"0 nothing, 1 \w+, 2 \w+", read_png(tmp_path / "0000.id.png")[2]["links"])
    assert render(run, "--times", "1", "--ids", "-o", tmp_path / "ids").returncode == 0
    assert sorted(files(tmp_path / "ids")) == ["0000.id.png", "0000.png"]


def test_a_video_without_ffmpeg_is_one_clear_line(run, tmp_path):
    programs = tmp_path / "bin"
    programs.mkdir()
    for folder in ("/bin", "/usr/bin"):
        for program in pathlib.Path(folder).iterdir():
            if program.name != "ffmpeg" and not (programs / program.name).is_symlink():
                (programs / program.name).symlink_to(program)
    done = render(run, "--video", tmp_path / "film.mp4", before=("env", f"PATH={programs}"))
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "apt-get install ffmpeg" in done.stderr


@pytest.mark.ffmpeg
@pytest.mark.skipif(not shutil.which("ffmpeg"), reason="ffmpeg is not installed")
def test_video(run, tmp_path):
    out = tmp_path / "film.mp4"
    done = render(run, "--video", out, "--fps", 10)
    assert done.returncode == 0, done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["film.mp4"]
    ask = ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=width,height,nb_read_frames,r_frame_rate,codec_name", "-of", "csv=p=0", str(out)]
    assert subprocess.run(ask, capture_output=True, text=True, check=True).stdout.strip() == "h264,160,120,10/1,21"
    done = render(run, "--video", tmp_path / "none" / "film.mp4", "--fps", 10, "-o", tmp_path / "frames")
    assert done.returncode == 1 and "none/film.mp4: cannot write the video: " in done.stderr and done.stderr.count("\n") == 1
    assert len(list((tmp_path / "frames").glob("0*.png"))) == 21


FILM_LENGTHS = pytest.mark.parametrize("every,fps,dt", [(1, 30, 0.005), (20, 30, 0.005), (1, 100, 0.05), (7, 60, 0.01), (1, 3, 0.02)])
# counts the pictures that it was given, in place of a film
COUNTING_FFMPEG = """#!/bin/sh
[ "$1" = -version ] && exit 0
for last; do :; done
for picture in [0-9]*.png; do [ -s "$picture" ] || exit 1; done
ls | grep -c '^[0-9]*[.]png$' >"$last"
"""


@FILM_LENGTHS
def test_a_film_has_as_many_pictures_as_the_run_is_long(tmp_path, every, fps, dt):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "ffmpeg").write_text(COUNTING_FFMPEG)
    (tmp_path / "bin" / "ffmpeg").chmod(0o755)
    done = lab.run(lab.experiment(tmp_path, dt=dt, duration=2.0), tmp_path / "run", "--solo", "--no-report", "--set", f"logger.every={every}")
    assert done.returncode == 0, done.stderr
    done = render(tmp_path / "run", "--video", tmp_path / "film.mp4", "--fps", fps, "--size", "64x48", "--quality", "draft",
                  before=("env", f"PATH={tmp_path / 'bin'}:{os.environ['PATH']}"))
    assert done.returncode == 0, done.stderr
    assert int((tmp_path / "film.mp4").read_text()) == 2 * fps + 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bin", "film.mp4", "motion.yaml", "run"]


@pytest.mark.ffmpeg
@pytest.mark.skipif(not shutil.which("ffmpeg"), reason="ffmpeg is not installed")
@FILM_LENGTHS
def test_a_film_lasts_as_long_as_the_run(tmp_path, every, fps, dt):
    """Few logged steps, long steps, many pictures: 2 s of simulation are 2 s of film, to one picture."""
    done = lab.run(lab.experiment(tmp_path, dt=dt, duration=2.0), tmp_path / "run", "--solo", "--no-report", "--set", f"logger.every={every}")
    assert done.returncode == 0, done.stderr
    done = render(tmp_path / "run", "--video", tmp_path / "film.mp4", "--fps", fps, "--size", "64x48", "--quality", "draft")
    assert done.returncode == 0, done.stderr
    ask = ["ffprobe", "-v", "error", "-show_entries", "format=duration", "-of", "csv=p=0", str(tmp_path / "film.mp4")]
    length = float(subprocess.run(ask, capture_output=True, text=True, check=True).stdout)
    assert 2 - 1e-3 <= length <= 2 + 1 / fps + 2e-3
    assert sorted(p.name for p in tmp_path.iterdir()) == ["film.mp4", "motion.yaml", "run"]


def refused(done, code, *words):
    assert done.returncode == code, done
    assert done.stderr.count("\n") == 1, done.stderr
    for word in words:
        assert word in done.stderr, done.stderr


def test_what_cannot_be_is_one_line(run, tmp_path):
    out = tmp_path / "out"
    refused(render(run, "--times", "0.5,7", "-o", out), 3, "--times: 7 s is outside the run, which lasts from 0 to 2 s")
    refused(render(run, "--times", "-1", "-o", out), 3, "outside the run")
    refused(render(run, "--size", "10000x10000", "-o", out), 2, "--size: 16 to 4096 pixels a side are possible, not 10000x10000")
    refused(render(run, "--size", "4096x4096", "-o", out), 1, "4096 x 4096 pixels is not possible")
    refused(render(run, "--size", "640x", "-o", out), 2, "must be like 640x480, not '640x'")
    refused(render(run, "--trace", "end_efector", "-o", out), 3, "no frame 'end_efector'", "did you mean 'end_effector'")
    refused(render(run, "--follow", "hand", "-o", out), 3, "--follow", "no frame 'hand'")
    refused(render(run, "--camera", "above", "-o", out), 2, "--camera", "above")
    refused(render(run, "--arrows", "velocity,tau", "-o", out), 2, "--arrows", "tau")
    refused(render(run), 2, "-o")
    refused(render(run, "--video", tmp_path / "film.avi", "-o", out), 2, "must be the name of an .mp4 file")
    refused(render(run, "--trace", "", "--trace-by", "error", "-o", out), 3, "--trace-by: there is no trace")
    empty = tmp_path / "empty.lcm"
    empty.touch()
    refused(render(empty, "-o", out), 3, "empty.lcm: there is no RUN in this log")
    head = (run / "log.lcm").read_bytes()
    (tmp_path / "short.lcm").write_bytes(head[:next(i for i in range(4, len(head)) if head[i:i + 4] == b"\xed\xa1\xda\x01")])
    refused(render(tmp_path / "short.lcm", "-o", out), 3, "there is no ROBOT_STATE in this log")
    assert not out.exists()
    (tmp_path / "file").touch()
    refused(render(run, "-o", tmp_path / "file" / "out"), 1, "file/out: cannot make this folder: Not a directory")
    refused(render(run, "-o", "/proc/here"), 1, "/proc/here: cannot make this folder: ")


def test_a_missing_mesh_is_told_once_and_strict_draws_nothing(tmp_path):
    """Three links with one file that is nowhere."""
    model = tmp_path / "arm.urdf"
    shape = '<visual><geometry><mesh filename="package://nowhere/arm.stl"/></geometry></visual>'
    model.write_text(re.sub(r"<visual>.*?</visual>", shape, (lab.ROOT / "models" / "simple_3dof_arm.urdf").read_text(), flags=re.S))
    done = lab.run(lab.experiment(tmp_path, duration=0.1), tmp_path / "run", "--solo", "--no-report", "--set", f"robot.model={model}")
    assert done.returncode == 0, done.stderr
    out = tmp_path / "out"
    done = render(tmp_path / "run", "--strict", "-o", out)
    assert done.returncode == 3 and "--strict: the robot is not whole, so nothing is drawn" in done.stderr and not out.exists()
    done = render(tmp_path / "run", "--size", "64x48", "-o", out)
    assert done.returncode == 0 and list(out.glob("*.png"))
    assert done.stderr.count("package://nowhere/arm.stl") == 1 and "magenta box" in done.stderr


def test_a_persons_own_pictures_are_not_replaced(run, tmp_path):
    mine = tmp_path / "mine"
    mine.mkdir()
    for name in ("0000.png", "contact.png"):
        (mine / name).write_bytes(b"\x89PNG\r\n\x1a\nholiday")
        done = render(run, "--times", "0,1", "-o", mine)
        assert done.returncode != 0 and f"{mine / name}: is not a picture of a run" in done.stderr
        assert files(mine) == {name: b"\x89PNG\r\n\x1a\nholiday"}
        (mine / name).unlink()
    (mine / "notes.txt").write_text("mine")
    for _ in range(2):  # its own pictures are
        assert render(run, "--times", "0,1", "-o", mine).returncode == 0
    assert (mine / "notes.txt").read_text() == "mine"


def test_an_unwritable_folder(run, tmp_path):
    """Read-only even for root: a mount of its own."""
    out = tmp_path / "out"
    out.mkdir()
    inside = ["unshare", "-rm", "sh", "-c", 'mount -t tmpfs -o ro,size=64k none "$0" && exec "$@"', str(out)]
    if subprocess.run([*inside, "true"], capture_output=True).returncode != 0:
        pytest.skip("no mount namespaces here")
    refused(render(run, "-j", 2, "-o", out, before=inside), 1, "png: cannot write picture: Read-only file system")


def test_a_full_disk(run, tmp_path):
    """What is there is whole; what is not leaves nothing."""
    out = tmp_path / "out"
    out.mkdir()
    pack = 'mount -t tmpfs -o size=256k none "$0" && { "$@"; code=$?; tar -C "$0" -cf "$0.tar" .; exit $code; }'
    inside = ["unshare", "-rm", "sh", "-c", pack, str(out)]
    if subprocess.run([*inside, "true"], capture_output=True).returncode != 0:
        pytest.skip("no mount namespaces here")
    for workers in (1, 2):
        refused(render(run, "--fps", 20, "-j", workers, "-o", out, before=inside), 1, "png: cannot write picture: No space left on device")
        there = tmp_path / f"there{workers}"
        there.mkdir()
        subprocess.run(["tar", "-C", there, "-xf", f"{out}.tar"], check=True)
        assert not no_halves(there)
        whole = list(there.glob("0*.png"))
        assert whole
        for path in whole:
            read_png(path)


def test_a_full_disk_ends_the_pictures_and_not_the_run(tmp_path):
    """The renderer alone sees a small disk at frames/."""
    small = "mkdir {run_dir}/frames && mount -t tmpfs -o size=64k none {run_dir}/frames && exec lab-renderer --run-dir {run_dir}"
    if subprocess.run(["unshare", "-rm", "mount", "-t", "tmpfs", "none", str(tmp_path)], capture_output=True).returncode != 0:
        pytest.skip("no mount namespaces here")
    file, solo = lab.experiment(tmp_path, duration=2.0), tmp_path / "solo"
    wanted = lab.solo(file, solo)
    with open(file, "a") as text:
        text.write(f"processes: {{renderer: \"unshare -rm sh -c '{small}'\"}}\n")
    done = lab.run(file, tmp_path / "run", *LOOKS)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "run" / "log.lcm").read_bytes() == wanted
    assert "png: cannot write picture: No space left on device" in (tmp_path / "run" / "processes" / "renderer.log").read_text()


def test_real_time_shows_the_newest_state(tmp_path):
    done = lab.run(lab.experiment(tmp_path, dt=0.002, duration=2.0), tmp_path / "run", "--clock", "realtime", *LOOKS)
    assert done.returncode == 0, done.stderr
    steps = [int(read_png(path)[2]["step"]) for path in sorted((tmp_path / "run" / "frames").iterdir())]
    assert steps == sorted(set(steps)) and 2 <= len(steps) <= 18 and steps[-1] <= 1000
    assert (tmp_path / "run" / "ghost.png").exists()
