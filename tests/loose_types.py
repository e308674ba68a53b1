"""Count `Any` in the public signatures of a package: `python tests/loose_types.py FOLDER ...`.

`Any` switches the type checker off wherever a value of it goes. Signatures are annotations of parameters and
results, of fields and attributes of classes, and of constants. What a name for a type stands for is one, too.
They are public if no name on the way to them begins with an underscore; methods such as `__init__` are
public, too. Names for types count whatever they are called, since a public signature may have them. Variables
inside functions do not count.
"""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path


def loose_signatures(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the line and the name of each public part of a module's signatures, once for each `Any` in it."""
    yield from _of_body(tree.body, "")


def check(folders: list[Path]) -> list[str]:
    """Return each `Any` in public signatures below these folders, as `file:line: name`."""
    return [
        f"{file}:{line}: {name}"
        for folder in folders
        for file in sorted(folder.rglob("*.py"))
        for line, name in loose_signatures(ast.parse(file.read_text(encoding="utf-8")))
    ]


def _of_body(body: list[ast.stmt], prefix: str) -> Iterator[tuple[int, str]]:
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            if _is_public(node.name):
                yield from _of_function(node, f"{prefix}{node.name}")
        elif isinstance(node, ast.ClassDef):
            if _is_public(node.name):
                for base in [*node.bases, *(keyword.value for keyword in node.keywords)]:
                    yield from _in(base, f"{prefix}{node.name}")
                yield from _of_body(node.body, f"{prefix}{node.name}.")
        elif isinstance(node, ast.AnnAssign):
            name = ast.unparse(node.target).removeprefix("self.")
            if _is_public(name):
                yield from _in(node.annotation, f"{prefix}{name}")
        elif isinstance(node, ast.Assign):
            yield from _in(node.value, f"{prefix}{ast.unparse(node.targets[0])}")
        elif isinstance(node, ast.If | ast.Try | ast.With | ast.For | ast.While):
            blocks = [getattr(node, name, []) for name in ("body", "orelse", "finalbody")]
            blocks += [handler.body for handler in getattr(node, "handlers", [])]
            for block in blocks:
                yield from _of_body(block, prefix)


def _of_function(node: ast.FunctionDef | ast.AsyncFunctionDef, name: str) -> Iterator[tuple[int, str]]:
    arguments = node.args
    every = [
        *arguments.posonlyargs,
        *arguments.args,
        *arguments.kwonlyargs,
        arguments.vararg,
        arguments.kwarg,
    ]
    for argument in every:
        if argument is not None and argument.annotation is not None:
            yield from _in(argument.annotation, f"{name}({argument.arg})")
    if node.returns is not None:
        yield from _in(node.returns, f"{name}()")
    for inner in ast.walk(node):
        if isinstance(inner, ast.AnnAssign) and ast.unparse(inner.target).startswith("self."):
            attribute = ast.unparse(inner.target).removeprefix("self.")
            if _is_public(attribute):
                yield from _in(inner.annotation, f"{name.rpartition('.')[0]}.{attribute}")
    yield from (
        found
        for inner in node.body
        if isinstance(inner, ast.FunctionDef) and _is_public(inner.name)
        for found in _of_function(inner, f"{name}.{inner.name}")
    )


def _in(annotation: ast.expr, name: str) -> Iterator[tuple[int, str]]:
    """Yield the line and the name for each `Any` in an expression; annotations may be texts."""
    for node in ast.walk(annotation):
        is_any = isinstance(node, ast.Name) and node.id == "Any"
        if is_any or (isinstance(node, ast.Attribute) and ast.unparse(node) == "typing.Any"):
            yield node.lineno, name
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and "Any" in node.value:
            try:
                inner = ast.parse(node.value, mode="eval").body
            except SyntaxError:
                continue  # a text that is no type
            yield from ((node.lineno, name) for _ in _in(inner, name))


def _is_public(name: str) -> bool:
    return not name.startswith("_") or (name.startswith("__") and name.endswith("__"))


if __name__ == "__main__":
    found = check([Path(argument) for argument in sys.argv[1:]])
    print("\n".join(found))
    print(f"{len(found)} times Any in public signatures")
    sys.exit(bool(found))
