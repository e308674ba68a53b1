"""Names of Numba, llvmlite and numba-cuda that the package relies on: the list is complete, and all exist.

Many of these names are private, so any minor version of Numba may change them. `pyproject.toml` excludes
the minor versions that nobody has tested. When a new version changes a name, these tests say which one.
"""

import ast
import importlib
import inspect
from collections import defaultdict
from functools import cache
from pathlib import Path

import numba
import pytest
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.cpu import CPUTargetOptions
from numba.core.registry import cpu_target

import swarm_gym
from helpers.loops import looped
from swarm_gym.compiler import jit
from swarm_gym.compiler.cache import KernelCache
from swarm_gym.compiler.linked_code import EntryCode, KernelCode, empty_code

PACKAGE = Path(swarm_gym.__file__).parent
LIBRARIES = ("numba", "llvmlite", "numba_cuda")

# Names that the package imports, or reads from a module that it imports, by the module.
NAMES = {
    "llvmlite.binding": {"Linkage.common", "Linkage.linkonce_odr", "ModuleRef", "parse_assembly"},
    "llvmlite.ir": {"Constant", "DoubleType", "FunctionType", "IntType", "Undefined", "VectorType"},
    "numba": {
        "config.BOUNDSCHECK", "config.DISABLE_JIT", "config.ENABLE_CUDASIM", "config.NUMBA_NUM_THREADS",
        "njit",
    },
    "numba.core.bytecode": {"FunctionIdentity._unique_ids"},
    "numba.core.caching": {
        "CompileResultCacheImpl", "FunctionCache", "FunctionCache.save_overload", "IndexDataCacheFile",
    },
    "numba.core.cgutils": {
        "add_global_variable", "do_boundscheck", "get_or_insert_function", "voidptr_t",
    },
    "numba.core.codegen": {"JITCodeLibrary"},
    "numba.core.compiler": {"CompilerBase", "DefaultPassBuilder.define_nopython_pipeline"},
    "numba.core.compiler_machinery": {"AnalysisPass", "register_pass"},
    "numba.core.ir": {"Expr"},
    "numba.core.registry": {"CPUDispatcher"},
    "numba.core.typed_passes": {"NopythonTypeInference"},
    "numba.core.typing.templates": {"infer", "infer_global", "make_intrinsic_template"},
    "numba.cuda": {
        "as_cuda_array", "ballot_sync", "blockIdx.x", "external_stream", "ffs", "jit", "shared.array",
        "shfl_sync", "shfl_xor_sync", "syncthreads", "syncwarp", "threadIdx.x",
    },
    "numba.extending": {"intrinsic", "models.PrimitiveModel", "overload", "register_model"},
    "numba.types": {
        "Array", "BaseNamedTuple", "BaseTuple", "Dispatcher", "Float", "Function", "Integer", "NamedUniTuple",
        "Type", "boolean", "float64", "int64", "intp", "none", "uint64", "uint8", "void",
    },
}  # fmt: skip
RELIED_ON = {f"{module}.{name}" for module, names in NAMES.items() for name in names}

# Methods and attributes of classes of Numba that a class of the package overrides or uses.
INHERITED = {
    "numba.core.caching.CompileResultCacheImpl": {"_locator_classes", "filename_base", "locator"},
    "numba.core.caching.FunctionCache": {
        "_cache_file", "_cache_path", "_impl", "_impl_class", "_index_key", "_py_func", "cache_path", "flush",
        "load_overload", "save_overload",
    },
    "numba.core.codegen.JITCodeLibrary": {
        "_codegen", "_final_module", "_finalize_dynamic_globals", "_finalize_final_module",
        "_get_module_for_linking", "_optimize_final_module", "_verify_declare_only_symbols", "name",
    },
    "numba.core.compiler.CompilerBase": {"define_pipelines", "state"},
    "numba.core.compiler_machinery.AnalysisPass": {"_name", "run_pass"},
    "numba.core.registry.CPUDispatcher": {"_cache", "compile", "py_func", "targetoptions"},
}  # fmt: skip

# Functions of `numba.cuda` that Python calls; only kernels call the others, and Python cannot read their
# arguments.
CALLED_BY_PYTHON = {"numba.cuda.as_cuda_array", "numba.cuda.external_stream", "numba.cuda.jit"}

# Attributes of the objects that Numba passes to code generators and passes, by the name of the parameter.
# The code generators of SIMD read more instructions of `builder` by name; test_simd.py compiles each of them.
PASSED = {
    "builder": {
        "add", "bitcast", "call", "extract_element", "extract_value", "fadd", "fcmp_ordered", "fptosi", "gep",
        "icmp_unsigned", "insert_element", "load", "module", "mul", "select", "shuffle_vector", "sitofp",
        "store", "uitofp", "zext",
    },
    "context": {"cast", "enable_boundscheck", "get_dummy_value", "make_array", "make_tuple"},
    "state": {"calltypes", "flags", "func_id", "return_type", "targetctx", "typemap"},
}  # fmt: skip
CLASSES = {"builder": "llvmlite.ir.IRBuilder", "context": "numba.core.base.BaseContext"}
JIT_OPTIONS = {
    "_nrt", "error_model", "forceinline", "inline", "no_cfunc_wrapper", "no_cpython_wrapper", "nogil",
}  # fmt: skip


def doubled(x):
    return 2 * x


@cache
def sources():
    """Return the syntax trees of all modules that import a library, with what each name stands for there."""
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = imports(tree)
        if names:
            found.append((tree, names))
    return found


def imports(tree):
    """Return the full name of everything that a module imports from the libraries, by its name there."""
    names = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                top = alias.name.partition(".")[0]
                if top in LIBRARIES:
                    names[alias.asname or top] = alias.name if alias.asname else top
        elif isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in LIBRARIES:
            names |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    return names


def full_name(node, names):
    """Return the full name that an expression stands for, or None if it is of no library."""
    if isinstance(node, ast.Name):
        return names.get(node.id)
    if isinstance(node, ast.Attribute):
        value = full_name(node.value, names)
        return value and f"{value}.{node.attr}"
    return None


def used():
    """Return the full names of everything that the package uses of the libraries."""
    found = set()
    for tree, names in sources():
        inner = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        found |= {full_name(node, names) for node in ast.walk(tree) if id(node) not in inner}
    return found - {None, *LIBRARIES}


def calls():
    """Return the name, number of arguments and keywords of every call of a library."""
    found = set()
    for tree, names in sources():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and (name := full_name(node.func, names)):
                starred = any(isinstance(argument, ast.Starred) for argument in node.args)
                keywords = tuple(sorted(keyword.arg for keyword in node.keywords if keyword.arg))
                is_called = not name.startswith("numba.cuda.") or name in CALLED_BY_PYTHON
                if is_called and not starred:
                    found.add((name, len(node.args), keywords))
    return sorted(found)


def object_of(name):
    """Return what a full name stands for in the installed version."""
    module, rest = name, []
    while True:
        try:
            found = importlib.import_module(module)
            break
        except ModuleNotFoundError:
            module, _, last = module.rpartition(".")
            rest.insert(0, last)
    for part in rest:
        found = getattr(found, part)
    return found


def needs_cuda(name):
    if name.startswith("numba.cuda."):
        pytest.importorskip("numba_cuda", reason="needs the extra `gpu`")


def test_the_list_names_exactly_what_the_package_uses():
    assert used() == RELIED_ON


@looped("name", sorted(RELIED_ON))
def test_a_name_exists(name):
    needs_cuda(name)
    object_of(name)


@looped(("name", "count", "keywords"), calls)
def test_a_function_takes_the_arguments_that_the_package_passes(name, count, keywords):
    needs_cuda(name)
    called = object_of(name)
    inspect.signature(called).bind(*[None] * count, **dict.fromkeys(keywords))


def own_classes():
    """Yield every class of the package whose base is a private one of Numba, with the name of this base."""
    for tree, names in sources():
        bases = dict(names)
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and node.bases:
                base = full_name(node.bases[0], bases)
                if base in RELIED_ON and base.startswith("numba.core."):
                    bases[node.name] = base
                    yield node, base


def inherited(node):
    """Return the attributes that the methods of a class use but that the class does not define."""
    defined = {child.name for child in node.body if isinstance(child, ast.FunctionDef)}
    read, of_super = set(), set()
    for child in ast.walk(node):
        if not isinstance(child, ast.Attribute):
            continue
        if isinstance(child.value, ast.Name) and child.value.id == "self":
            (defined if isinstance(child.ctx, ast.Store) else read).add(child.attr)
        elif isinstance(child.value, ast.Call) and getattr(child.value.func, "id", "") == "super":
            of_super.add(child.attr)
    return (read - defined) | of_super - {"__init__"}


def test_the_list_names_what_classes_inherit():
    found = defaultdict(set)
    for node, base in own_classes():
        found[base] |= inherited(node)
    assert set(found) == set(INHERITED)
    assert {base: names - INHERITED[base] for base, names in found.items() if names - INHERITED[base]} == {}


@pytest.mark.parametrize(
    ("own", "base"),
    [
        (KernelCache.load_overload, "numba.core.caching.FunctionCache.load_overload"),
        (KernelCache.save_overload, "numba.core.caching.FunctionCache.save_overload"),
        (KernelCache._index_key, "numba.core.caching.FunctionCache._index_key"),
        (jit._Dispatcher.compile, "numba.core.registry.CPUDispatcher.compile"),
        (jit._Compiler.define_pipelines, "numba.core.compiler.CompilerBase.define_pipelines"),
        (EntryCode._optimize_final_module, "numba.core.codegen.CPUCodeLibrary._optimize_final_module"),
        (KernelCode._optimize_final_module, "numba.core.codegen.CPUCodeLibrary._optimize_final_module"),
        (KernelCode._finalize_final_module, "numba.core.codegen.CPUCodeLibrary._finalize_final_module"),
    ],
)
def test_a_method_has_the_arguments_of_the_one_that_it_overrides(own, base):
    expected = inspect.signature(object_of(base)).parameters.values()
    assert [one.kind for one in inspect.signature(own).parameters.values()] == [one.kind for one in expected]


def exist(names, *owners):
    assert [name for name in sorted(names) if not any(hasattr(owner, name) for owner in owners)] == []


def test_the_attributes_of_caches_exist():
    cached = KernelCache(doubled, {})
    assert {"_cache_file", "_cache_path", "_impl", "_py_func"} <= set(vars(cached))
    exist(INHERITED["numba.core.caching.FunctionCache"], cached)
    assert hasattr(object_of("numba.core.caching.FunctionCache"), "_impl_class")
    assert hasattr(object_of("numba.core.caching.CompileResultCacheImpl"), "_locator_classes")
    exist(INHERITED["numba.core.caching.CompileResultCacheImpl"], cached._impl)


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_the_attributes_of_libraries_of_code_exist():
    library = empty_code(KernelCode, cpu_target.target_context.codegen(), "doubled")
    exist(INHERITED["numba.core.codegen.JITCodeLibrary"], library)
    assert not library._finalized
    exist({"_create_empty_module"}, library._codegen)


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_the_attributes_of_dispatchers_compilers_and_passes_exist():
    states = []

    class Compiler(CompilerBase):
        def define_pipelines(self):
            states.append(self.state)
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            exist({"add_pass_after", "finalize"}, passes)
            passes.finalize()
            return [passes]

    dispatcher = numba.njit(pipeline_class=Compiler)(doubled)
    assert dispatcher(3) == 6
    exist(INHERITED["numba.core.registry.CPUDispatcher"], dispatcher)
    exist(PASSED["state"], *states)
    assert states[0].flags.nrt in (True, False)
    exist({"contains_nrt_meminfo"}, states[0].targetctx.data_model_manager[numba.types.float64])
    exist(INHERITED["numba.core.compiler_machinery.AnalysisPass"], jit._CheckBorrowing)


def test_the_list_names_what_the_package_reads_of_the_objects_that_numba_passes():
    found = {name: set() for name in PASSED}
    for tree, _ in sources():
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and getattr(node.value, "id", None) in found:
                found[node.value.id].add(node.attr)
    assert found == PASSED


@pytest.mark.parametrize("parameter", CLASSES)
def test_the_objects_that_numba_passes_have_the_attributes(parameter):
    exist(PASSED[parameter], object_of(CLASSES[parameter]))


def test_numba_knows_the_options_of_kernels():
    exist(JIT_OPTIONS, CPUTargetOptions)
