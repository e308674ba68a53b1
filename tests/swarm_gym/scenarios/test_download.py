import hashlib
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest

from helpers.public_maps import needed
from swarm_gym.scenarios import download
from swarm_gym.scenarios.download import MAPS, RemoteFile, RemoteFolder, main
from swarm_gym.scenarios.formats.data_files import find_data_file

CONTENT = {"maps/one.map": b"one", "maps/one.map.scen": b"problems", "two.yaml": b"two"}


class QuietHandler(SimpleHTTPRequestHandler):
    def log_message(self, *arguments):
        """Log nothing."""


@pytest.fixture
def served(tmp_path):
    """Return the folder of a server, which has the files, and its address."""
    root = tmp_path / "server"
    for name, content in CONTENT.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_bytes(content)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(QuietHandler, directory=str(root)))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield root, f"http://127.0.0.1:{server.server_address[1]}/"
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.fixture
def folder(tmp_path, monkeypatch, served):
    """Return the data folder, which does not exist yet; the maps to download are those of the server."""

    def remote(name):
        content = CONTENT[name]
        source = RemoteFolder(served[1], "made, cite nobody")
        local = f"movingai/{name.removeprefix('maps/')}"
        return RemoteFile(source, name, local, len(content), hashlib.sha256(content).hexdigest())

    made = {"one": (remote("maps/one.map"), remote("maps/one.map.scen")), "two": (remote("two.yaml"),)}
    monkeypatch.setattr(download, "MAPS", made)
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path / "data"))
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    return tmp_path / "data"


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_all_maps_are_downloaded_and_found(folder, capsys):
    assert main([]) == 0
    assert contents(folder) == {"one.map": b"one", "one.map.scen": b"problems", "two.yaml": b"two"}
    assert find_data_file("one.map") == folder / "movingai/one.map"
    printed = capsys.readouterr().out
    assert str(folder) in printed
    assert "movingai/one.map: downloaded, 3 bytes" in printed
    assert printed.count("made, cite nobody") == 1


def test_maps_are_chosen_by_name(folder):
    assert main(["two"]) == 0
    assert contents(folder) == {"two.yaml": b"two"}


def test_an_unknown_name_is_refused_with_the_valid_ones(folder, capsys):
    with pytest.raises(SystemExit) as caught:
        main(["one", "three"])
    assert caught.value.code == 2
    printed = capsys.readouterr().err
    assert "'three'" in printed
    assert "one, two" in printed
    assert not folder.exists()


def test_what_is_there_and_right_is_not_downloaded_again(folder, served, capsys):
    main(["one"])
    (served[0] / "maps/one.map").unlink()
    assert main(["one"]) == 0
    assert "movingai/one.map: is there" in capsys.readouterr().out


def test_what_differs_is_replaced_only_by_force(folder, capsys):
    (folder / "movingai").mkdir(parents=True)
    (folder / "movingai/one.map").write_bytes(b"mine")
    assert main(["one"]) == 1
    assert contents(folder) == {"one.map": b"mine", "one.map.scen": b"problems"}
    printed = capsys.readouterr().err
    assert str(folder / "movingai/one.map") in printed
    assert "--force" in printed
    assert main(["one", "--force"]) == 0
    assert contents(folder) == {"one.map": b"one", "one.map.scen": b"problems"}


@pytest.mark.parametrize("content", [b"own", b"onetwo", b"on", b""])
def test_a_file_that_is_not_the_expected_one_is_not_kept(folder, served, capsys, content):
    (served[0] / "maps/one.map").write_bytes(content)
    assert main(["one"]) == 1
    assert contents(folder) == {"one.map.scen": b"problems"}
    printed = capsys.readouterr().err
    assert f"{served[1]}maps/one.map" in printed
    assert "1 of 2 files" in printed


def test_a_file_that_is_gone_is_reported_with_its_address(folder, served, capsys):
    (served[0] / "two.yaml").unlink()
    assert main(["two"]) == 1
    assert f"{served[1]}two.yaml cannot be downloaded" in capsys.readouterr().err
    assert contents(folder) == {}


def test_without_a_network_nothing_is_written_and_the_exit_code_is_one(folder, monkeypatch, capsys):
    file = download.MAPS["two"][0]
    discard = RemoteFolder("http://127.0.0.1:9/", "")  # the discard port: nobody listens
    nowhere = file._replace(source=discard)
    monkeypatch.setattr(download, "MAPS", {"two": (nowhere,)})
    assert main([]) == 1
    assert "http://127.0.0.1:9/two.yaml cannot be downloaded" in capsys.readouterr().err
    assert not folder.exists()


def test_a_folder_that_cannot_be_written_is_reported(folder, capsys):
    folder.write_bytes(b"a file in the place of the folder")
    assert main(["two"]) == 1
    assert f"{folder / 'movingai/two.yaml'} cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize(
    "file", [file for files in MAPS.values() for file in files], ids=lambda file: file.path
)
def test_a_public_file_is_named_by_a_commit_and_known_by_its_content(file):
    assert file.source.url.startswith("https://")
    commit = file.source.url.rstrip("/").rpartition("/")[2]
    assert len(commit) == 40
    int(commit, 16)
    assert len(file.sha256) == 64
    assert 0 < file.size < 500_000


@pytest.mark.parametrize(
    "file", [file for files in MAPS.values() for file in files], ids=lambda file: file.path
)
def test_a_public_file_that_was_downloaded_is_the_published_one(file):
    content = needed(file.local).read_bytes()
    assert (len(content), hashlib.sha256(content).hexdigest()) == (file.size, file.sha256)
