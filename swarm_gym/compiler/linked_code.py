"""Code of kernels, which is linked into entries and only there optimised and made into machine code.

By default, Numba optimises each function that it compiles, with all that it calls, and makes machine code of
it, since Python might call it. Python never calls the compiled code of a kernel, see `jit.kernel`. So the
code of a kernel is optimised once in each entry, and not at each level of calls.

Code is linked by names. Numba makes a name from the function's name in the source, its types and a number:
it numbers the functions that a process compiles. Two processes may give one number to two functions, such as
two lambdas of one file. An entry that linked both from the cache had one of them in place of the other. Here
the numbers are random.
"""

import secrets
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from llvmlite import binding, ir
from numba.core import cgutils
from numba.core.bytecode import FunctionIdentity
from numba.core.codegen import JITCodeLibrary

if TYPE_CHECKING:  # a private name, which may change without any harm
    from numba.core.codegen import Codegen

Code = TypeVar("Code", bound=JITCodeLibrary)

# This holds for every function that Numba compiles, since kernels call functions of other modules, too.
# Among a million of them, two have the same number with a chance of 1e-7.
FunctionIdentity._unique_ids = iter(partial(secrets.randbits, 62), None)


def empty_code(kind: type[Code], codegen: "Codegen", name: str) -> Code:
    """Return a place for the code of one function, which the cache can keep."""
    code = kind(codegen, name)
    code.enable_object_caching()
    return code


class EntryCode(JITCodeLibrary):
    """The code of one entry, to which its copy of each kernel belongs alone.

    So LLVM inlines a kernel that is called at one place, however large it is. Copies have no names for others
    to find, since LLVM may leave out arguments of a kernel where it knows all calls.
    """

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == binding.Linkage.linkonce_odr:
                function.linkage = "private"
        super()._optimize_final_module()


class KernelCode(JITCodeLibrary):
    """The code of one kernel, for others to link.

    Numba's engine gets a module of the kernel's environments only. These are places for the address of what
    the kernel needs from Python, such as a global object; Numba fills them when the kernel has been compiled.
    """

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True  # else Numba would come back to this method for the module to link
        linked = self._get_module_for_linking()
        self._final_module = self._environments(linked)
        super()._finalize_final_module()

    def _environments(self, linked: binding.ModuleRef) -> binding.ModuleRef:
        """Return a module that has nothing but the environments of a module."""
        module = self._codegen._create_empty_module(self.name)
        for variable in linked.global_variables:
            if variable.linkage == binding.Linkage.common:
                place = cgutils.add_global_variable(module, cgutils.voidptr_t, variable.name)
                place.linkage = "common"
                place.initializer = ir.Constant(cgutils.voidptr_t, None)
        return binding.parse_assembly(str(module))
