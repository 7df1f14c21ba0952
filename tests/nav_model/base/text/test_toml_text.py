"""Hostile texts are refused, or read, within the memory and the processor time that are stated."""

import subprocess
import sys
import tomllib

import pytest

from nav_model.base.errors import InputError
from nav_model.base.text.toml_text import MOST_KEYS, read_toml

MB = 1_000_000

# In a process of its own, so that what it took is what reading took: MB, seconds of processor time, what was said.
_READ = """
import resource, sys, time
from nav_model.base.errors import InputError
from nav_model.base.text.toml_text import read_toml
def taken():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
text = eval(sys.argv[1])
before, began = taken(), time.process_time()
try:
    read_toml(text, "file", "a design file", 1_000_000)
    said = "read"
except InputError as error:
    said = str(error)
print(taken() - before, time.process_time() - began, said)
"""


def _cost(text: str) -> tuple[float, str]:
    """MB taken at most, and what was said; fails if it took more than ten times the time stated."""
    done = subprocess.run([sys.executable, "-c", _READ, text], capture_output=True, text=True, check=True)
    memory, seconds, message = done.stdout.split(" ", 2)
    assert float(seconds) < 10
    return float(memory), message.strip()


@pytest.mark.long
@pytest.mark.parametrize(
    "text",
    [
        "'.'.join('a' * 15_000) + '=1'",
        "' . '.join(['\"a\"'] * 15_000) + '=1'",
        "'[' + '.'.join('a' * 15_000) + ']'",
        "'x={' + '.'.join('a' * 15_000) + '=1}'",
        "'x={a=\"\"\"b\"\"\"\",' + '.'.join('a' * 15_000) + '=1}'",
        "'a=' + '[' * 400_000",
        "'a=' + '{a=' * 200_000",
        "''.join(f'a{i}.b.c.d.e.f=1\\n' for i in range(40_000))",
        "'[a]\\n' * 200_000",
        "'a=[' + '1,' * 490_000 + ']'",
        '\'a="""\' + \'\\\\\\\\"""\' * 160_000',
        "\"a='\" + \"'''\" * 300_000",
        "'a=\"' + '\\\\n' * 490_000 + '\"'",
        "'a' * 1_000_000",
        "' ' * 999_999 + 'a'",
        '\'a="""\' + (\'""x\' * 300_000)',
        "''.join(f'a{i}=1\\n' for i in range(9_900))",
        "''.join(f'[a{i}.b.c.d.e.f.g]\\n' for i in range(9_900))",
        "''.join(f'[[a]]\\nb={i}\\n' for i in range(4_900))",
    ],
)
def test_no_text_takes_more_than_50_times_its_size(text: str) -> None:
    memory, _ = _cost(text)
    assert memory < 50


def test_what_is_refused_is_told_by_its_reason() -> None:
    for text, reason in [
        ("a=" + "[" * 9 + "]" * 9, "nested more than 8 deep"),
        ("a=1\n" * (MOST_KEYS + 1), f"more than {MOST_KEYS} keys"),
        ("#" * (MB + 1), "larger than 1 MB; not a design file"),
        (b"a='\xff'", "not a text file (byte 3 is not UTF-8)"),
        ("a=", "not a design file (TOML): Invalid value"),
    ]:
        with pytest.raises(InputError) as caught:
            read_toml(text, "file", "a design file", MB)
        assert caught.value.key == "file"
        assert reason in caught.value.reason
    with pytest.raises(InputError, match=r"^imu.rate: a key of 9 parts; a design file has none of more than 8"):
        read_toml("imu.rate" + ".a" * 7 + "=1", "file", "a design file", MB)


@pytest.mark.parametrize(
    "text",
    [
        "a = '1.2.3.4.5.6.7.8.9.10.11'  # ..........[[[[[[[[[[[",
        'a = "..........\\"[[[[[[[[[[[[" # {{{{{{{{{{{',
        'a = """[[[[[[[[[[[["" \\""" ........... """"\nb = 1.5',
        "a = '''..........\n'' [[[[[[[[[[[ '''''\nb = 2026-11-22T10:00:00.5Z",
        "a.b.c.d.e.f.g.h = [[[[[[[1]]]]]]]",
        '"a.b.c.d.e.f.g.h.i.j.k" = 1',
    ],
)
def test_what_is_quoted_does_not_count(text: str) -> None:
    assert read_toml(text, "file", "a design file", MB) == tomllib.loads(text)
