"""Files that appear complete or not at all."""

from __future__ import annotations

import contextlib
import json
import math
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from devseg.errors import DevsegError

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextlib.contextmanager
def staged(directory: Path) -> Iterator[Path]:
    """A folder to write into, whose files move into `directory` when the block succeeds.

    The folder lies inside `directory`, so that moving is a rename. After a failure nothing is
    left of it, nor of `directory` if it was made for this.

    Raises:
        DevsegError: where `directory` cannot be written.
    """
    made = not directory.exists()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".devseg-", dir=directory))
    except OSError as error:
        raise DevsegError(
            f"cannot write into {directory} ({error.strerror}); choose another -o DIR"
        ) from error
    try:
        yield staging
        _publish(staging, directory)
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        if made:
            with contextlib.suppress(OSError):
                directory.rmdir()
        raise
    shutil.rmtree(staging, ignore_errors=True)


def _publish(staging: Path, directory: Path) -> None:
    files = sorted(staging.iterdir())
    for file in files:
        if (directory / file.name).is_dir():
            raise DevsegError(
                f"{directory / file.name} is a folder, a file of that name is to be written; "
                "choose another -o DIR"
            )
    for file in files:
        file.replace(directory / file.name)


def to_json(value: Any) -> str:
    """Strict JSON: arrays become lists, numbers that are not finite become null."""
    return json.dumps(_finite(plain(value)), indent=2, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """The same without NumPy, which need not be imported to read it: arrays become lists."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
