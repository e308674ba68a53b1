"""Annotations that Python computes when a module is imported."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCES = [
    path for folder in ("swarm_gym", "agents", "experiments") for path in (ROOT / folder).rglob("*.py")
]
UNION = "def f(x: ArrayLike | 'torch.Tensor') -> None: ..."


def is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def mixed_unions(text: str) -> list[str]:
    """Return the unions of a type and a string, which NumPy 2.5 refuses for its own types."""
    nodes = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.BinOp))
    unions = (node for node in nodes if isinstance(node.op, ast.BitOr))
    return [ast.unparse(node) for node in unions if is_text(node.left) or is_text(node.right)]


def test_a_union_of_a_type_and_a_string_is_found() -> None:
    assert mixed_unions(UNION) == ["ArrayLike | 'torch.Tensor'"]
    assert (
        mixed_unions(UNION.replace("'", "").replace("ArrayLike | torch.Tensor", "'ArrayLike | torch.Tensor'"))
        == []
    )


def test_no_module_joins_a_type_and_a_string() -> None:
    found = {path.name: mixed_unions(path.read_text(encoding="utf-8")) for path in SOURCES}
    assert {name: unions for name, unions in found.items() if unions} == {}
