"""Code that assumes Linux has a branch for other systems; tests simulate what it would see there."""

import ast
import errno
import hashlib
import math
import os
import platform
import signal
import sys
from functools import cache
from pathlib import Path

import pytest

from agents.backends import BackendError, BackendOptions
from experiments.speed import measurement, start
from swarm_gym import files
from swarm_gym.command import command
from swarm_gym.files import digest_of_sources, write_atomically
from swarm_gym.gpu.host import free_host_memory

ROOT = Path(__file__).parents[2]
SOURCES = [
    path for folder in ("swarm_gym", "agents", "experiments") for path in (ROOT / folder).rglob("*.py")
]

# What Windows, or macOS too, does not have.
MODULES = {"crypt", "fcntl", "grp", "posix", "pty", "pwd", "resource", "syslog", "termios", "tty"}
ATTRIBUTES = {
    "os": {
        "O_DIRECTORY", "chown", "fchmod", "fork", "forkpty", "getegid", "geteuid", "getgid", "getloadavg",
        "getpgid", "getuid", "kill", "killpg", "mkfifo", "nice", "pread", "sched_getaffinity", "setsid",
        "statvfs", "sync", "sysconf", "uname", "wait", "wait4",
    },
    "signal": {
        "SIGALRM", "SIGCHLD", "SIGCONT", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGQUIT", "SIGSTOP", "SIGUSR1",
        "SIGUSR2", "alarm", "pause", "pthread_kill", "setitimer", "sigwait",
    },
}  # fmt: skip
FOLDERS = ("/proc", "/dev", "/sys", "/tmp", "/etc", "/var", "/usr", "/bin", "/home")
FORKS = {"fork", "forkserver"}

# Where these are used, with a branch that a test below tries.
BRANCHES = {
    "agents/backends/slurm.py": {"signal.SIGUSR2"},
    "experiments/speed/measurement.py": {"/proc/cpuinfo"},
    "experiments/speed/start.py": {"/proc/self/status", "resource"},
    "swarm_gym/gpu/host.py": {"os.sysconf"},
}


def assumptions(tree):
    """Yield names that a module uses and that another system lacks."""
    for node in ast.walk(tree):
        match node:
            case ast.Import():
                yield from (alias.name for alias in node.names if alias.name in MODULES)
            case ast.ImportFrom():
                yield from {node.module} & MODULES
                lacking = ATTRIBUTES.get(node.module, ())
                yield from (f"{node.module}.{alias.name}" for alias in node.names if alias.name in lacking)
            case ast.Attribute(value=ast.Name(id=module), attr=name):
                yield from {f"{module}.{name}"} if name in ATTRIBUTES.get(module, ()) else ()
            case ast.Constant(value=str(text)) if text.startswith(FOLDERS) or text in FORKS:
                yield text


def text_without_encoding(tree):
    """Yield the lines that read or write a text in the encoding of the system."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or any(keyword.arg == "encoding" for keyword in node.keywords):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        modes = {one.value for one in node.args if isinstance(one, ast.Constant)}
        if name == "open":
            is_builtin = isinstance(node.func, ast.Name)
            is_text = modes & {"r", "w", "a", "x"} or (is_builtin and not modes & {"rb", "wb", "ab", "xb"})
        else:
            is_text = name in ("read_text", "write_text")
        if is_text:
            yield node.lineno


@cache
def parsed(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def test_only_places_with_a_branch_use_what_other_systems_lack():
    found = {path: set(assumptions(parsed(path))) for path in SOURCES}
    assert {path.relative_to(ROOT).as_posix(): used for path, used in found.items() if used} == BRANCHES


def test_texts_have_an_encoding_that_does_not_depend_on_the_system():
    found = {path: [*text_without_encoding(parsed(path))] for path in SOURCES}
    assert {str(path): lines for path, lines in found.items() if lines} == {}


def test_the_two_searches_find_what_they_search():
    code = "import os, resource\nos.fork()\nPath('/proc/stat').read_text()\nopen(name, 'w')\npath.open('a')"
    assert set(assumptions(ast.parse(code))) == {"resource", "os.fork", "/proc/stat"}
    assert list(text_without_encoding(ast.parse(code))) == [3, 4, 5]
    harmless = "os.getpid()\npath.read_text(encoding='utf-8')\nopen(name, 'rb')\nimage.open(content)"
    assert not [*assumptions(ast.parse(harmless)), *text_without_encoding(ast.parse(harmless))]


# Memory and processor.


def raising(error):
    def raises(*_):
        raise error

    return raises


def test_free_memory_is_unlimited_where_the_system_does_not_tell_it(monkeypatch):
    monkeypatch.setattr(os, "sysconf", raising(ValueError("unrecognized configuration name")), raising=False)
    assert free_host_memory() == sys.maxsize  # as on macOS
    monkeypatch.setattr(os, "sysconf", lambda _: -1)
    assert free_host_memory() == sys.maxsize
    monkeypatch.delattr(os, "sysconf")
    assert free_host_memory() == sys.maxsize  # as on Windows


def test_free_memory_is_a_number_of_pages(monkeypatch):
    numbers = {"SC_PAGE_SIZE": 4096, "SC_AVPHYS_PAGES": 10}
    monkeypatch.setattr(os, "sysconf", numbers.get, raising=False)
    assert free_host_memory() == 40960


class Resource:
    """The module `resource` of a process whose peak is the number 3000."""

    RUSAGE_SELF = 0
    ru_maxrss = 3000

    @classmethod
    def getrusage(cls, _):
        return cls


@pytest.mark.parametrize(("system", "expected"), [("darwin", 3000), ("freebsd14", 3000 * 1024)])
def test_peak_memory_is_in_bytes_on_other_systems_than_linux(tmp_path, monkeypatch, system, expected):
    monkeypatch.setattr(start, "STATUS", tmp_path / "none")
    monkeypatch.setitem(sys.modules, "resource", Resource)
    monkeypatch.setattr(sys, "platform", system)
    assert start.peak_bytes() == expected


def test_peak_memory_is_not_a_number_on_windows(tmp_path, monkeypatch):
    monkeypatch.setattr(start, "STATUS", tmp_path / "none")
    monkeypatch.setitem(sys.modules, "resource", None)
    assert math.isnan(start.peak_bytes())
    monkeypatch.setattr(start, "run_python", lambda _: "nan\n")
    assert math.isnan(start.peak_mebibytes())


@pytest.mark.parametrize(
    ("status", "expected"), [("VmHWM:\t   12 kB\n", 12 * 1024), ("VmRSS: 5 kB\n", 3000 * 1024)]
)
def test_peak_memory_on_linux_is_read_where_it_is_told(tmp_path, monkeypatch, status, expected):
    (tmp_path / "status").write_text(f"Name: python\n{status}", encoding="utf-8")
    monkeypatch.setattr(start, "STATUS", tmp_path / "status")
    monkeypatch.setitem(sys.modules, "resource", Resource)
    monkeypatch.setattr(sys, "platform", "linux")
    assert start.peak_bytes() == expected


@pytest.mark.parametrize(
    ("described", "processor", "machine", "expected"),
    [
        ("processor: 0\nmodel name\t: A 9000 @ 3 GHz\nmodel name\t: other\n", "", "x86_64", "A 9000 @ 3 GHz"),
        ("processor: 0\nCPU part\t: 0xd0c\n", "", "aarch64", "aarch64"),  # Linux on ARM
        (None, "arm", "arm64", "arm"),  # macOS
        (None, "Intel64 Family 6", "AMD64", "Intel64 Family 6"),  # Windows
        (None, "", "", "unknown"),
    ],
)
def test_the_processor_has_a_name(tmp_path, monkeypatch, described, processor, machine, expected):
    if described is not None:
        (tmp_path / "cpuinfo").write_text(described, encoding="utf-8")
    monkeypatch.setattr(measurement, "PROCESSORS", tmp_path / "cpuinfo")
    monkeypatch.setattr(platform, "processor", lambda: processor)
    monkeypatch.setattr(platform, "machine", lambda: machine)
    assert measurement.machine()["processor"] == expected


# Files.


def test_a_file_is_written_where_folders_cannot_be_opened(tmp_path, monkeypatch):
    monkeypatch.setattr(files.os, "open", raising(PermissionError(errno.EACCES, "Permission denied")))
    assert write_atomically(tmp_path / "a", "text").read_bytes() == b"text"


def fail_for_folders(monkeypatch, error):
    true, calls = os.fsync, []

    def fsync(descriptor):
        calls.append(descriptor)
        if len(calls) == 2:  # the first call is for the file
            raise error
        true(descriptor)

    monkeypatch.setattr(files.os, "open", lambda *_: os.dup(1))  # a descriptor, also where folders have none
    monkeypatch.setattr(files.os, "fsync", fsync)
    return calls


@pytest.mark.parametrize("number", [errno.EINVAL, errno.EBADF, errno.ENOTSUP])
def test_a_file_is_written_where_folders_cannot_be_synchronised(tmp_path, monkeypatch, number):
    calls = fail_for_folders(monkeypatch, OSError(number, os.strerror(number)))
    assert write_atomically(tmp_path / "a", "text").read_bytes() == b"text"
    assert len(calls) == 2


def test_a_disk_that_fails_while_a_folder_is_synchronised_is_reported(tmp_path, monkeypatch):
    fail_for_folders(monkeypatch, OSError(errno.EIO, "Input/output error"))
    with pytest.raises(OSError, match="Input/output error"):
        write_atomically(tmp_path / "a", "text")


def refuse_replacing(monkeypatch, times):
    """Refuse this number of times to replace a file, as Windows does while a program reads the target."""
    true, calls = os.replace, []

    def replace(*arguments):
        calls.append(arguments)
        if len(calls) <= times:
            raise PermissionError(errno.EACCES, "Access is denied")
        true(*arguments)

    monkeypatch.setattr(files.os, "replace", replace)
    monkeypatch.setattr(files, "REPLACE_TIMEOUT", 0.1)
    return calls


def test_on_windows_a_file_is_replaced_as_soon_as_nobody_reads_it(tmp_path, monkeypatch):
    write_atomically(tmp_path / "a", "old")
    calls = refuse_replacing(monkeypatch, 2)
    monkeypatch.setattr(files, "REFUSES_OPEN_FILES", True)
    write_atomically(tmp_path / "a", "new")
    assert (tmp_path / "a").read_bytes() == b"new"
    assert len(calls) == 3


@pytest.mark.parametrize("windows", [True, False])
def test_a_file_that_cannot_be_replaced_is_named_and_the_old_one_is_kept(tmp_path, monkeypatch, windows):
    write_atomically(tmp_path / "a", "old")
    calls = refuse_replacing(monkeypatch, 1000)
    monkeypatch.setattr(files, "REFUSES_OPEN_FILES", windows)
    with pytest.raises(PermissionError, match=r"Access is denied.*a'"):
        write_atomically(tmp_path / "a", "new")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    assert (tmp_path / "a").read_bytes() == b"old"
    assert (len(calls) > 1) == windows


def test_the_digest_of_sources_has_neither_separators_nor_the_order_of_a_system(tmp_path):
    contents = {"top/B.py": b"1\n", "top/a.py": b"2\n", "top/a/c.py": b"3\n"}
    for name, content in contents.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(content)
    ordered = [(name, contents[name]) for name in ("top/B.py", "top/a/c.py", "top/a.py")]
    expected = hashlib.sha256(b"".join(name.encode() + content for name, content in ordered))
    assert digest_of_sources(tmp_path / "top") == expected.hexdigest()[:16]


# Signals.


def test_ctrl_break_ends_a_command_as_sigterm_does(monkeypatch, capsys):
    number = getattr(signal, "SIGBREAK", None) or signal.SIGUSR1  # stands for it where there is none
    monkeypatch.setattr(signal, "SIGBREAK", number, raising=False)
    before = signal.getsignal(number)
    with pytest.raises(SystemExit) as caught, command(kept="all is kept"):
        signal.raise_signal(number)
    assert caught.value.code == 143
    assert capsys.readouterr().err == "\nterminated; all is kept\n"
    assert signal.getsignal(number) is before


def test_a_command_ends_well_where_there_is_no_ctrl_break(monkeypatch):
    monkeypatch.delattr(signal, "SIGBREAK", raising=False)
    with command():
        pass


def test_slurm_is_refused_on_windows_and_something_else_is_named(tmp_path, monkeypatch):
    monkeypatch.delattr(signal, "SIGUSR2", raising=False)
    with pytest.raises(BackendError, match=r"Windows does not have.*--backend local"):
        BackendOptions("slurm", "local", jobs=1).make(tmp_path)
    assert list(tmp_path.iterdir()) == []
