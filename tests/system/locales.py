"""Locales whose numbers and letters differ, made for a test when this machine does not have them."""
import functools
import pathlib
import shutil
import subprocess

import pytest

from labrun import DEADLINE

LOCALES = ["C", "de_DE.UTF-8", "tr_TR.UTF-8"]


@functools.cache
def made_locale(folder, name):
    """LOCPATH that has the locale; None if this machine cannot make it (package locales)."""
    language = name.split(".")[0]
    if not shutil.which("localedef") or not pathlib.Path("/usr/share/i18n/locales", language).exists():
        return None
    subprocess.run(["localedef", "-i", language, "-f", "UTF-8", f"{folder}/{name}"], check=False, capture_output=True, timeout=DEADLINE)
    return str(folder) if pathlib.Path(folder, name, "LC_NUMERIC").exists() else None


def locale(folder, name):
    if name == "C":
        return {"LC_ALL": "C"}
    path = made_locale(folder, name)
    if not path:
        pytest.skip(f"no locale {name} here")
    return {"LC_ALL": name, "LOCPATH": path}
