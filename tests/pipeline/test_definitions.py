# ruff: noqa: E501 - a module of a package is one text, and reads best in one line
"""Laws of reach: an edit changes a task's digest exactly where the task can reach it by name.

Every construct is a little package `p` with the task `p.m:t`, edits that the task cannot reach and edits that it can.
"""

import ast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetree.pipeline.identity.definitions import Code

Package = dict[str, str]


def reached(package: Package, root: str = "t"):
    """What the task reaches, with the syntax of each."""
    return Code({f"p.{name}" if name else "p.__init__": text for name, text in package.items()}).reached("p.m", root)


# construct: modules, edits that change nothing, edits that change it; an edit is "module: old → new"
CASES: dict[str, tuple[Package, list[str], list[str]]] = {
    "function": (
        {"m": "def t(): return f()\ndef f(): return 11\ndef g(): return 22"},
        ["m: 22 → 23", "m: g() → g(x)", "m: 22 → f()"],
        ["m: 11 → 12", "m: f(): return 11 → f(x): return 11", "m: t(): → t(x):"],
    ),
    "comments and docstrings": (
        {"m": '"""A."""\nX = 1\n"""B."""\ndef t():\n    """C."""\n    return X  # D\n'},
        ["m: A. → E.", "m: B. → E.", "m: C. → E.", "m: D → E"],
        ["m: X = 1 → X = 2"],
    ),
    "decorator and its arguments": (
        {
            "m": "from p.d import plain, made, other\nLIMIT = 33\n@made(LIMIT, 44)\n@plain\ndef t(): return 1\n@other\ndef u(): return 2",
            "d": "def plain(f): return f\ndef made(*a): return plain\ndef other(f): return 55 or f",
        },
        ["d: 55 → 56", "m: return 2 → return 3"],
        ["m: 33 → 34", "m: 44 → 45", "m: @plain → @made(1)", "d: made(*a): return plain → made(*a): return print"],
    ),
    "default argument": (
        {"m": "A, B = 11, 22\ndef t(x=A): return x\ndef u(x=B): return x"},
        ["m: 22 → 23"],
        ["m: 11 → 12", "m: x=A → x=A + 1"],
    ),
    "default of a keyword": ({"m": "A, B = 11, 22\ndef t(*, x=A): return x\ndef u(*, x=B): 0"}, ["m: 22 → 23"], ["m: 11 → 12"]),
    "annotation": (
        {
            "m": "from p.s import Mesh, Other\ndef t(x: Mesh, *y: int) -> None: ...",
            "s": "class Mesh: size = 11\nclass Other: size = 22",
        },
        ["s: 22 → 23"],
        ["s: 11 → 12", "m: x: Mesh → x: Other", "m: -> None → -> int"],
    ),
    "annotation as text": (
        {
            "m": 'from p import s\ndef t(x: "tuple[s.Mesh, ...]") -> "Graph": ...\nclass Graph: g = 33',
            "s": "class Mesh: size = 11\nclass Other: size = 22",
        },
        ["s: 22 → 23"],
        ["s: 11 → 12", "m: 33 → 34"],
    ),
    "literals in annotations are no names": (
        {"m": 'from typing import Literal\ndef t(x: Literal["u"]): ...\ndef u(): return 11'},
        ["m: 11 → 12"],
        ['m: ["u"] → ["v"]'],
    ),
    "texts that are types outside annotations": (
        {
            "m": 'from typing import TypeVar, cast\nT = TypeVar("T", bound="A")\nclass A: a = 11\nclass B: b = 22\nclass C: c = 33\n'
            'def t(x: T): return cast("B", x)'
        },
        ["m: 33 → 34"],
        ["m: 11 → 12", "m: 22 → 23"],
    ),
    "class body": (
        {
            "m": "from typing import ClassVar\nfrom p.f import field, D, E\nclass A:\n    x: int = field(D)\n    y: ClassVar[int] = 11\n"
            "    def used(self): return 22\n    def unused(self): return E\nclass B: z = 33\ndef t(a: A): return a.used()",
            "f": "D = 44\nE = 55\nF = 66\ndef field(x): return x",
        },
        ["m: 33 → 34", "f: 66 → 67"],
        ["m: 11 → 12", "m: 22 → 23", "f: 44 → 45", "f: 55 → 56", "f: return x → return 1", "m: x: int → x: float"],
    ),
    "bases, metaclasses": (
        {
            "m": "class Meta(type): a = 11\nclass Base(metaclass=Meta): b = 22\nclass Own(Base): c = 33\nclass Sister(dict): d = 44\n"
            "def t(): return Own()"
        },
        ["m: 44 → 45"],
        ["m: 11 → 12", "m: 22 → 23", "m: 33 → 34"],
    ),
    "NamedTuple and dataclass": (
        {
            "m": "from typing import NamedTuple\nfrom dataclasses import dataclass\nclass A(NamedTuple):\n    x: float = 11\n"
            "@dataclass(frozen=True)\nclass B:\n    y: A\n@dataclass\nclass C:\n    z: int = 22\ndef t(): return B(A())"
        },
        ["m: 22 → 23", "m: z: int → z: float"],
        ["m: 11 → 12", "m: frozen=True → frozen=False", "m: x: float → x: int"],
    ),
    "constants computed at import": (
        {
            "m": "from p.n import scale\nA = 11\nB = [scale(a) for a in (A, 22)]\nC = scale(33)\ndef t(): return B",
            "n": "K = 44\nL = 55\ndef scale(x): return K * x",
        },
        ["m: 33 → 34", "n: 55 → 56"],
        ["m: 11 → 12", "m: 22 → 23", "n: 44 → 45", "n: K * x → K + x"],
    ),
    "unpacked in pairs": ({"m": "A, B = 11, 22\ndef t(): return A"}, ["m: 22 → 23"], ["m: 11 → 12"]),
    "unpacked otherwise": (
        {"m": "A, (B, *C) = 11, (22, 33)\nD = 44\ndef t(): return C"},
        ["m: 44 → 45"],
        ["m: 11 → 12", "m: 22 → 23", "m: 33 → 34"],
    ),
    "stars in tuples": (
        {"m": "def a(): 11\ndef b(): 22\ndef c(): 33\nA = (a,)\nB = (*A, b)\nC = (*A, c)\ndef t(): return B"},
        ["m: 33 → 34"],
        ["m: 11 → 12", "m: 22 → 23", "m: (*A, b) → (b, *A)"],
    ),
    "bound twice": (
        {"m": "A = 11\nB = 22\nA = A * 33\nA += 44\ndef t(): return A"},
        ["m: 22 → 23"],
        ["m: 11 → 12", "m: 33 → 34", "m: 44 → 45", "m: A = A * 33\nA += 44 → A += 44\nA = A * 33", "m: A += 44\n → "],
    ),
    "bound under a condition": (
        {
            "m": "import sys\nBIG = 11\nif sys.maxsize > BIG:\n    A = 22\n    B = 33\nelif BIG:\n    A = 44\nelse:\n    A = 55\ndef t(): return A"
        },
        ["m: 33 → 34"],
        ["m: 22 → 23", "m: 44 → 45", "m: 55 → 56", "m: 11 → 12", "m: sys.maxsize > → sys.maxsize <"],
    ),
    "moved to the other branch": (
        {"m": "if 1:\n    A = 22\nelse:\n    B = 3\ndef t(): return A"},
        ["m: B = 3 → B = 4"],
        ["m: if 1:\n    A = 22\nelse:\n    B = 3 → if 1:\n    B = 3\nelse:\n    A = 22"],
    ),
    "bound in try": (
        {"m": "try:\n    import fast as A\nexcept ImportError:\n    A = 11\nfinally:\n    B = 22\nC = 33\ndef t(): return A"},
        ["m: 33 → 34"],
        ["m: 11 → 12", "m: fast → faster", "m: ImportError → OSError"],
    ),
    "bound in for, with and while": (
        {
            "m": "S = 11\nT = {}\nfor k in range(S):\n    T[k] = 22\nwith open('a') as A:\n    U = A.read(33)\nwhile S:\n    S = S - 44\nV = 55\n"
            "def t(): return k, U, T"
        },
        ["m: 55 → 56"],
        ["m: 11 → 12", "m: 22 → 23", "m: 33 → 34", "m: 44 → 45"],
    ),
    "bound by :=": (
        {"m": "if (A := 11) > (B := 22):\n    pass\nprint_ = (C := 33)\nD = 44\ndef t(): return C"},
        ["m: 44 → 45"],
        ["m: 33 → 34"],
    ),
    "bound by match": (
        {
            "m": "import sys\nmatch sys.argv:\n    case [A, *B]:\n        C = 11\n    case _:\n        A = 22\nD = 33\ndef t(): return A"
        },
        ["m: 33 → 34"],
        ["m: 11 → 12", "m: 22 → 23", "m: [A, *B] → [A, B]"],
    ),
    "deleted": ({"m": "A = 11\nB = 22\ndel A\ndef t(): return A"}, ["m: 22 → 23"], ["m: del A → del B"]),
    "global": (
        {
            "m": "A = 1\nB = 2\ndef setter():\n    global A\n    A = 33\ndef other():\n    global B\n    B = 44\ndef t(): return A"
        },
        ["m: 44 → 45"],
        ["m: 33 → 34"],
    ),
    "global that is bound nowhere else": (
        {
            "m": "def setter(x):\n    def inner():\n        global A\n        A = 33 + x\n    inner()\nB = 22\nsetter(11)\ndef t(): return A"
        },
        ["m: 22 → 23"],
        ["m: 33 → 34", "m: 11 → 12"],
    ),
    "side effect on a constant": (
        {
            "m": "FIELD = {}\nOTHER = {}\nFIELD.update(a=11)\nOTHER.update(a=22)\nFIELD['b'] = 33\ndel FIELD['a']\nOTHER['b'] = 44\ndef t(): return FIELD"
        },
        ["m: 22 → 23", "m: 44 → 45"],
        [
            "m: 11 → 12",
            "m: 33 → 34",
            "m: del FIELD['a']\n → ",
            "m: FIELD.update(a=11) → FIELD.update(b=11)",
            "m: FIELD['b'] = 33\ndel FIELD['a'] → del FIELD['a']\nFIELD['b'] = 33",
        ],
    ),
    "side effect from another module": (
        {
            "m": "import p.e\nfrom p.c import TABLE\ndef t(): return TABLE",
            "c": "TABLE = []\nLIST = []",
            "e": "from p import c\nX = 11\nY = 22\nc.TABLE.append(X)\nc.LIST.append(Y)",
        },
        ["e: 22 → 23"],
        ["e: 11 → 12", "e: c.TABLE.append(X) → c.TABLE.insert(0, X)"],
    ),
    "side effect through another name": (
        {
            "m": "TABLE = {}\nLIST = {}\nBOTH = {'a': TABLE}\nOWN = {'a': LIST}\nBOTH['a'].update(b=11)\nOWN['a'].update(b=22)\ndef t(): return TABLE"
        },
        ["m: 22 → 23"],
        ["m: 11 → 12"],
    ),
    "attribute set at import": (
        {
            "m": "class A: x = 11\nclass B: x = 22\ndef f(): 0\nA.y = 33\nB.y = 44\nsetattr(A, 'z', 55)\nf.limit = 66\ndef t(): return A, f"
        },
        ["m: 44 → 45"],
        ["m: 33 → 34", "m: 55 → 56", "m: 66 → 67"],
    ),
    "module's attribute set from outside": (
        {
            "m": "from p import c, e\ndef t(): return c.LIMIT",
            "c": "LIMIT = 1\nOTHER = 2",
            "e": "from p import c\nc.LIMIT = 33\nc.OTHER = 44",
        },
        ["e: 44 → 45"],
        ["e: 33 → 34"],
    ),
    "statement that changes the world": (
        {"m": "import p.e\ndef t(): return 1.0", "e": "import numpy as np\nX = 22\nnp.seterr(all='ignore')"},
        ["e: 22 → 23"],
        ["e: 'ignore' → 'raise'"],
    ),
    "call that changes the world": (
        {
            "m": "import p.e\ndef t(): return 1.0",
            "e": "import numpy as np\ndef quiet(): np.seterr(all='ignore')\ndef no(): 22\nquiet()",
        },
        ["e: 22 → 23"],
        ["e: 'ignore' → 'raise'"],
    ),
    "registered by decorator": (
        {
            "": "from p import w, z",
            "m": "from p.r import WRITERS\ndef t(k): return WRITERS[k]()",
            "r": "WRITERS, READERS = {}, {}\ndef writer(name):\n    def keep(f):\n        WRITERS[name] = f\n        return f\n    return keep\n"
            "def reader(f): READERS[f.__name__] = f; return f",
            "w": "from p.r import writer, reader\n@writer('a')\ndef a(): return 11\n@reader\ndef b(): return 22",
            "z": "from p.r import writer\ndef c(): return 33\nD = writer('c')(c)\n",
        },
        ["w: 22 → 23"],
        ["w: 11 → 12", "w: writer('a') → writer('b')", "z: 33 → 34", ": w, z → z, w"],
    ),
    "registered for a class that the task reads": (
        {
            "": "import p.w",
            "m": "from p.s import Mesh\ndef t(x: Mesh): return x",
            "s": "class Mesh: size = 11",
            "r": "WORDS = {}\ndef words(cls):\n    def keep(f):\n        WORDS[cls] = f\n        return f\n    return keep",
            "w": "from p.r import words\nfrom p.s import Mesh\n@words(Mesh)\ndef mesh(m): return 'two words'",
        },
        ["w: two → three", "r: WORDS[cls] = f → WORDS[cls, 1] = f"],
        ["s: 11 → 12"],
    ),
    "registered by a decorator that changes the class": (
        {
            "": "import p.w",
            "m": "from p.s import Mesh\ndef t(x: Mesh): return x",
            "s": "class Mesh: size = 11",
            "r": "def method(cls):\n    def keep(f):\n        setattr(cls, f.__name__, f)\n        return f\n    return keep",
            "w": "from p.r import method\nfrom p.s import Mesh\n@method(Mesh)\ndef area(m): return 22\ndef other(m): return 33",
        },
        ["w: 33 → 34"],
        ["w: 22 → 23"],
    ),
    "singledispatch": (
        {
            "": "import p.w",
            "m": "from p.s import area\ndef t(x): return area(x)",
            "s": "from functools import singledispatch\n@singledispatch\ndef area(x): return 11\n@singledispatch\ndef size(x): return 22",
            "w": "from p.s import area, size\n@area.register\ndef _(x: int): return 33\n@size.register\ndef other(x: int): return 44",
        },
        ["w: 44 → 45", "s: 22 → 23"],
        ["s: 11 → 12", "w: 33 → 34"],
    ),
    "subclasses that make themselves known": (
        {
            "": "import p.w",
            "m": "from p.s import Base\ndef t(): return Base.known",
            "w": "from p.s import Base, Free\nclass A(Base): a = 22\nclass B(Free): b = 33",
            "s": "class Base:\n    known = []\n    def __init_subclass__(cls): Base.known.append(cls)\nclass Free: f = 11",
        },
        ["w: 33 → 34", "s: 11 → 12"],
        ["w: 22 → 23"],
    ),
    "guards": (
        {
            "": "if __name__ != 'p':\n    raise ImportError('11')\nfrom p import e",
            "m": "if __name__ != 'p.m':\n    raise ImportError(f'{22} words')\ndef t(): return 1\nif __name__ == '__main__':\n    print(t(33))",
            "e": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from p.m import t\n    X = 44",
        },
        [": 11 → 12", "m: 22 → 23", "m: 33 → 34", "e: 44 → 45"],
        ["m: return 1 → return 2"],
    ),
    "imported for types alone": (
        {
            "m": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from p.s import A, B\ndef t(x: 'A'): 0\ndef u(x: 'B'): 0",
            "s": "class A: a = 11\nclass B: b = 22",
        },
        ["s: 22 → 23"],
        ["s: 11 → 12"],
    ),
    "from import under another name": (
        {"m": "from p.n import a as f, b as g\ndef t(): return f()", "n": "def a(): return 11\ndef b(): return 22"},
        ["n: 22 → 23", "m: , b as g → "],
        ["n: 11 → 12", "m: a as f, b as g → b as f, a as g"],
    ),
    "module under another name": (
        {"m": "import p.n as n\ndef t(): return n.a()", "n": "def a(): return 11\ndef b(): return 22"},
        ["n: 22 → 23", "n: b(): return 22 → c(): return 22"],
        ["n: 11 → 12"],
    ),
    "module by its full name": (
        {
            "m": "import p.sub.n\nimport p.k\ndef t(): return p.sub.n.a()",
            "sub.__init__": "X = 33",
            "sub.n": "def a(): return 11\ndef b(): return 22",
            "k": "X = 44",
        },
        ["sub.n: 22 → 23", "sub.__init__: 33 → 34", "k: 44 → 45"],
        ["sub.n: 11 → 12"],
    ),
    "module from a package, relatively": (
        {
            "sub.__init__": "",
            "m": "from .sub import n as numerics\ndef t(): return numerics.a()",
            "sub.n": "from ..k import b\nfrom . import o\ndef a(): return b() + o.c()",
            "k": "def b(): return 11\nX = 22",
            "sub.o": "def c(): return 33\nY = 44",
        },
        ["k: 22 → 23", "sub.o: 44 → 45"],
        ["k: 11 → 12", "sub.o: 33 → 34"],
    ),
    "module as a value": (
        {
            "m": "from p import n, k\ndef t(name): return getattr(n, name)()\ndef u(): return k",
            "n": "def a(): return 11\ndef b(): return K\nK = 22",
            "k": "X = 33",
        },
        ["k: 33 → 34"],
        ["n: 11 → 12", "n: 22 → 23", "n: K = 22 → K = 22\nL = 1"],
    ),
    "module handed on under a local name": (
        {"m": "def t():\n    import p.n as n\n    return vars(n)", "n": "def a(): return 11", "k": "X = 33"},
        ["k: 33 → 34"],
        ["n: 11 → 12"],
    ),
    "name that a module does not show": (
        {"m": "from p import n\ndef t(): return n.shadow", "n": "X = 11", "k": "X = 33"},
        ["k: 33 → 34"],
        ["n: 11 → 12"],
    ),
    "__getattr__ of a module": (
        {"m": "from p.n import shadow\ndef t(): return shadow", "n": "def __getattr__(name): return 11\nX = 22"},
        ["n: 22 → 23"],
        ["n: 11 → 12"],
    ),
    "globals()": (
        {
            "m": "def t(k): return globals()[k]\ndef a(): return 11\nfrom p.n import b",
            "n": "def b(): return 22\ndef c(): return 33",
        },
        ["n: 33 → 34"],
        ["m: 11 → 12"],
    ),
    "exec and eval": ({"m": "def t(k): return eval(k)\ndef a(): return 11", "k": "X = 2"}, ["k: 2 → 3"], ["m: 11 → 12"]),
    "module imported by a computed name": (
        {
            "m": "from importlib import import_module\ndef t(k): return import_module(f'p.sub.{k}')\ndef a(): return 11",
            "sub.__init__": "",
            "sub.x": "X = 22",
            "k": "X = 33",
        },
        ["k: 33 → 34"],
        ["m: 11 → 12", "sub.x: 22 → 23"],
    ),
    "import *": (
        {
            "m": "from p.n import *\ndef t(): return a()",
            "n": "from p.k import *\ndef b(): return 22",
            "k": "def a(): return 11",
            "o": "X = 33",
        },
        ["o: 33 → 34"],
        ["k: 11 → 12", "n: 22 → 23"],
    ),
    "re-export": (
        {
            "m": "from p.sub import a\nimport p.sub\ndef t(): return a() + p.sub.c()",
            "sub.__init__": "from .n import a, b\nfrom .n import d as c\nX = 44",
            "sub.n": "def a(): return 11\ndef b(): return 22\ndef d(): return 33",
        },
        ["sub.n: 22 → 23", "sub.__init__: 44 → 45"],
        ["sub.n: 11 → 12", "sub.n: 33 → 34", "sub.__init__: d as c → b as c", "sub.__init__: import a, b → import b as a"],
    ),
    "package and module of one name": (
        {
            "m": "from p.sub import n\ndef t(): return n()",
            "sub.__init__": "from .n import n",
            "sub.n": "def n(): return 11\ndef b(): return 22",
        },
        ["sub.n: 22 → 23"],
        ["sub.n: 11 → 12"],
    ),
    "imported within a function": (
        {
            "m": "def t():\n    from p.n import a\n    import p.k as k\n    return a(k.c)\ndef b(): 33",
            "n": "def a(x): return 11\ndef b(): return 22",
            "k": "c, d = 44, 55",
        },
        ["n: 22 → 23", "m: 33 → 34", "k: 55 → 56"],
        ["n: 11 → 12", "k: 44 → 45"],
    ),
    "nested functions and classes": (
        {
            "m": "A, B, C = 11, 22, 33\ndef t():\n    def f():\n        class K:\n            x = A\n            def g(self): return lambda: B\n        return K\n    return f"
        },
        ["m: 33 → 34"],
        ["m: 11 → 12", "m: 22 → 23"],
    ),
    "comprehensions have scopes": (
        {
            "m": "def f(): return 11\ndef x(): return 22\nY = [33]\ndef t(): return [x for x in Y for _ in x if x], [f for f in Y], f()"
        },
        ["m: 22 → 23"],
        ["m: 11 → 12", "m: 33 → 34"],
    ),
    "locals hide": (
        {
            "m": "def a(): return 11\ndef b(): return 22\ndef c(): return 33\ndef t(a):\n    b = a\n    for c in b: pass\n    return a, b, c"
        },
        ["m: 11 → 12", "m: 22 → 23", "m: 33 → 34"],
        ["m: b = a → b = 1"],
    ),
    "class bodies hide nothing from methods": (
        {"m": "def a(): return 11\nclass K:\n    a = 1\n    b = a\n    def f(self): return a()\ndef t(): return K"},
        [],
        ["m: 11 → 12"],
    ),
    "compiled functions that call compiled functions": (
        {
            "m": "from p.n import outer\ndef t(): return outer(1)",
            "c": "import numba\ndef compiled(f): return numba.njit(f)",
            "n": "from p.c import compiled\nfrom p.k import inner\n@compiled\ndef outer(x): return inner(x)\n@compiled\ndef other(x): return 11",
            "k": "from p.c import compiled\nLIMIT = 22\n@compiled\ndef inner(x): return LIMIT\n@compiled\ndef loose(x): return 33",
        },
        ["n: 11 → 12", "k: 33 → 34"],
        ["k: 22 → 23", "n: inner(x) → inner(x + 1)", "c: njit(f) → jit(f)"],
    ),
    "type aliases": (
        {"m": "from typing import Annotated\nA = int\nB = float\nV = Annotated[A, 11]\nW = Annotated[B, 22]\ndef t(x: V): 0"},
        ["m: 22 → 23", "m: B = float → B = str"],
        ["m: 11 → 12", "m: A = int → A = str"],
    ),
    "rings": (
        {"m": "from p.n import f\ndef t(n): return f(n)\ndef u(): 22", "n": "from p import m\ndef f(n): return 11 or m.t(n)"},
        ["m: 22 → 23"],
        ["n: 11 → 12"],
    ),
    "code that counts for nothing": (
        {"m": "import json\nfrom elsewhere.x import y\ndef t(): return json, y\ndef u(): 22"},
        ["m: 22 → 23"],
        ["m: import y → import z as y"],
    ),
}


def edited(package: Package, edit: str) -> Package:
    """The package after an edit, which must fit at exactly one place and leave code that can be read."""
    module, _, change = edit.partition(":")
    old, _, new = change.removeprefix(" ").partition(" → ")
    assert package[module].count(old) == 1, f"{old!r} stands {package[module].count(old)} times in {module}"
    text = package[module].replace(old, new)
    ast.parse(text)
    return {**package, module: text}


@pytest.mark.parametrize("harmless", [(), ("loom",)])
def test_what_is_handed_to_a_package_that_changes_no_result_counts_for_nothing(harmless):
    texts = {
        "p.m": "from p.views import Mesh\ndef t(): return Mesh",
        "p.views": "from loom.views import provide\nclass Mesh: pass\nprovide(Mesh, 11)",
    }
    before = Code(texts, harmless).reached("p.m", "t")
    after = Code({**texts, "p.views": texts["p.views"].replace("11", "12")}, harmless).reached("p.m", "t")
    assert (before == after) == bool(harmless)


@pytest.mark.parametrize(("construct", "edit"), [(c, e) for c, (_, same, _) in CASES.items() for e in same])
def test_edits_that_a_task_cannot_reach_leave_its_code_alone(construct, edit):
    package = CASES[construct][0]
    assert reached(edited(package, edit)) == reached(package)


@pytest.mark.parametrize(("construct", "edit"), [(c, e) for c, (_, _, other) in CASES.items() for e in other])
def test_edits_that_a_task_can_reach_change_its_code(construct, edit):
    package = CASES[construct][0]
    assert reached(edited(package, edit)) != reached(package)


def test_a_task_that_is_not_there_counts_its_whole_module():
    assert set(reached({"m": "A = 1\nB = 2"}, "t")) == {("p.m", "A"), ("p.m", "B")}


# ── generated packages: reach is what the generator's own graph says ────────────────────────────────────────────────

KINDS = ("function", "class", "constant", "compiled", "method", "computed", "twice")


@st.composite
def packages(draw):
    """Definitions in modules, each with a kind and references to others in one of several forms of import."""
    count = draw(st.integers(2, 9))
    modules = [f"m{k}" for k in range(draw(st.integers(1, 3)))]
    return [
        {
            "module": draw(st.sampled_from(modules)),
            "kind": draw(st.sampled_from(KINDS)),
            "refers": draw(
                st.lists(st.tuples(st.integers(0, count - 1), st.sampled_from("nafl")), max_size=3, unique_by=lambda r: r[0])
            ),
        }
        for _ in range(count)
    ]


def reference(definitions, one, other, form):
    """How a definition writes another's name: (import statement at the top, statement within a function, expression)."""
    home, away = definitions[one]["module"], definitions[other]["module"]
    if home == away and form != "l":
        return "", "", f"d{other}"
    return {
        "n": (f"from g.{away} import d{other}", "", f"d{other}"),
        "a": (f"import g.{away}", "", f"g.{away}.d{other}"),
        "f": (f"from g import {away} as m_{away}", "", f"m_{away}.d{other}"),
        "l": ("", f"from g.{away} import d{other} as own{other}", f"own{other}"),
    }[form]


def written(definitions, numbers):
    """The package as texts by module; definition k holds the number `numbers[k]`."""
    texts = {f"g.{module}": ["from g.c import compiled"] for module in sorted({d["module"] for d in definitions})}
    for k, d in enumerate(definitions):
        eager = d["kind"] in ("constant", "computed", "twice")
        references = [reference(definitions, k, other, "n" if eager and form == "l" else form) for other, form in d["refers"]]
        value = ", ".join([str(numbers[k]), *(expression for _, _, expression in references)])
        inner = "; ".join([*(within for _, within, _ in references if within), f"return {value},"])
        body = {
            "function": f"def d{k}(): {inner}",
            "class": f"class d{k}:\n    def use(self): {inner}",
            "method": f"class d{k}:\n    number: int = {numbers[k]}\n    @property\n    def use(self): {inner}",
            "compiled": f"@compiled\ndef d{k}(d0=0): {inner}".replace("(d0=0)", "()"),
            "constant": f"d{k} = ({value},)",
            "computed": f"d{k} = [str(x) for x in ({value},)]",
            "twice": f"d{k} = 0\nd{k} = ({value}, d{k})",
        }[d["kind"]]
        texts[f"g.{d['module']}"] += [*(top for top, _, _ in references if top), body]
    return {"g.__init__": "", "g.c": "def compiled(f): return f", **{name: "\n".join(lines) for name, lines in texts.items()}}


def reachable(definitions, start):
    """The definitions that one reaches, by the generator's own graph."""
    reached, waiting = set(), [start]
    while waiting:
        one = waiting.pop()
        if one not in reached:
            reached.add(one)
            waiting += [other for other, _ in definitions[one]["refers"]]
    return reached


@settings(max_examples=300, deadline=None)
@given(packages(), st.data())
def test_digest_changes_exactly_where_the_edited_definition_is_reachable(definitions, data):
    start = data.draw(st.integers(0, len(definitions) - 1))
    changed = data.draw(st.integers(0, len(definitions) - 1))
    numbers = [100 + k for k in range(len(definitions))]
    root = (f"g.{definitions[start]['module']}", f"d{start}")
    before = Code(written(definitions, numbers)).reached(*root)
    numbers[changed] += 100
    after = Code(written(definitions, numbers)).reached(*root)
    assert (before != after) == (changed in reachable(definitions, start))
