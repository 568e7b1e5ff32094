"""Tests that need what `scripts/lab setup --test` does not install have a marker; ctest runs each marker by itself and is
told "skipped" when nothing of it could run."""
import labrun as lab
import pytest

NEEDS = {"robots": "scripts/lab robots", "ffmpeg": "ffmpeg", "foreman": "foreman", "slurm": "Slurm, as root"}
ALL_SKIPPED = 77  # SKIP_RETURN_CODE in CMakeLists.txt


def pytest_configure(config):
    for name, what in NEEDS.items():
        config.addinivalue_line("markers", f"{name}: needs {what}")


def pytest_sessionfinish(session, exitstatus):
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    ran = any(reporter.stats.get(kind) for kind in ("passed", "failed", "error"))
    if exitstatus == pytest.ExitCode.OK and not ran:
        session.exitstatus = ALL_SKIPPED


@pytest.fixture
def runs(tmp_path):
    """A folder for runs; labs that still run in it are ended by their own supervisors."""
    folder = tmp_path / "runs"
    yield folder
    lab.call(folder, "down", "--all", "--timeout", "5")
    assert not lab.leftovers(folder)
