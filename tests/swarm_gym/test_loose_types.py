"""The public signatures of the package say their types: none of them has `Any`."""

import ast
from pathlib import Path

import pytest

import loose_types
import swarm_gym

MOST = 0  # times `Any` in public signatures of swarm_gym


def test_public_signatures_have_no_more_any_than_before():
    found = loose_types.check([Path(swarm_gym.__file__).parent])
    assert len(found) <= MOST, "\n".join(["say what these are; `object` is a type, too:", *found])


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("def f(a: Any, *b: int, **c: Any) -> Any: ...", ["f(a)", "f(c)", "f()"]),
        ("def f(a: dict[str, Any | Any]): ...", ["f(a)", "f(a)"]),
        ("def f(a: 'list[Any]', b: typing.Any): ...", ["f(a)", "f(b)"]),
        ("class C(B[Any]):\n a: Any\n def f(self, b: Any): self.c: Any = b", ["C", "C.a", "C.f(b)", "C.c"]),
        ("class C:\n class D:\n  def f(self) -> Any: ...", ["C.D.f()"]),
        ("def f():\n def g(a: Any): ...\n return g", ["f.g(a)"]),
        ("A: Any = 1", ["A"]),
        ("_Alias = dict[str, Any]\nT = TypeVar('T', bound='Any')", ["_Alias", "T"]),
        ("if x:\n def f(a: Any): ...\nelse:\n def g(a: Any): ...", ["f(a)", "g(a)"]),
        ("try:\n a: Any\nexcept E:\n b: Any", ["a", "b"]),
    ],
)  # fmt: skip
def test_any_is_counted_wherever_a_caller_sees_it(source, names):
    assert [name for _, name in loose_types.loose_signatures(ast.parse(source))] == names


@pytest.mark.parametrize(
    "source",
    [
        "def _f(a: Any): ...",
        "class _C:\n a: Any",
        "class C:\n _a: Any\n def _f(self) -> Any: ...",
        "def f():\n a: Any = 1\n def _g(b: Any): ...",
        "_A: Any = 1",
        "def f(a: object, text: str = 'Any text at all'): ...",
        "MESSAGE = 'Any text at all'",
    ],
)
def test_any_that_no_caller_sees_is_not_counted(source):
    assert not [*loose_types.loose_signatures(ast.parse(source))]
