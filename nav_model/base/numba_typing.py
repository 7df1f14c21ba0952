"""Remembers what Numba has found about the types of an operation, which speeds up compiling.

For every `a[i]` in a kernel Numba asks up to eleven templates in turn, and each of them compares all the compiler's
flags: a fifth of the time that compiling takes. The answer depends on the function with its templates, the types
and the flags alone, which are also the keys of each template's own cache.

Report to send upstream, version and end: docs/upstream/numba_typing.md
"""

from typing import Any

from numba.core.targetconfig import ConfigStack
from numba.core.types.functions import BaseFunction

_function: Any = BaseFunction  # Numba's types leave out part of what is used here
_stack: Any = ConfigStack
as_shipped: Any = BaseFunction.get_call_type
_signatures: dict[Any, Any] = {}


def remembered(function: Any, context: Any, args: Any, kws: Any) -> Any:
    """The signature `function` has for arguments of these types.

    Parameters
    ----------
    function : BaseFunction
        Numba's type of a function with its templates.
    context, args, kws
        As `BaseFunction.get_call_type` takes them: the typing context, the types of arguments by place and by name.

    Raises
    ------
    TypingError
        As Numba does, where there is no such signature.
    """
    key = function, context, tuple(args), tuple(kws.items()), _stack.top_or_none()
    if key not in _signatures:
        _signatures[key] = as_shipped(function, context, args, kws)
    return _signatures[key]


def remember() -> None:
    """Have Numba ask here first, in this process."""
    _function.get_call_type = remembered
