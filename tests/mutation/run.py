#!/usr/bin/env python3
"""Mutates the physics, one operator, sign or constant at a time, and says what no test notices.

    python3 tests/mutation/run.py wgsl --sample 200 --seed 1
    python3 tests/mutation/run.py rust --sample 100 --seed 1
    python3 tests/mutation/run.py wgsl            # all of them: hours

Outside the suite, plain Python 3. Results stand in WORK/wgsl.csv and WORK/rust.csv, a line for each
mutant; a run that was stopped goes on where it was. WORK is `mutation` in CARGO_TARGET_DIR (or in
./target), or --work.

Both languages are judged in a crate of the physics alone, generated in WORK, so that nothing waits
for the engine: its library is units, colour, optics, reference and the narrowing of
src/sheet/uniform.rs; its tests are the unit tests of these, tests/parity.rs, tests/judged.rs, and
tiers.rs, lobes.rs and matter.rs of tests/physics. The first failure ends a mutant. One that does not
compile, or that the shader compiler refuses, does not count.

A mutant of a shader is laid in a folder that the tests' support code reads (RECTO_MUTANTS) and
needs no compiling. Mutants of Rust are compiled together, each behind a switch that RECTO_MUTANT
throws (tests/mutation/switches writes them), so that one costs no more than the tests. What
stands in a constant, a pattern or a type, and what the compiler refuses behind a switch, is
compiled alone, after the others. Rust that takes more than six times as long as the sound tests, and
20 s, never ends.

tests/mutation/survivors.md explains those that are left.
"""

import argparse
import csv
import json
import math
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHADERS = [f"shaders/paper_{name}.wgsl" for name in ("bsdf", "baselines", "media")]
# Not medium.rs and medium/catalogue.rs, which are data. Arrays of numbers are left out below.
SOURCES = [f"src/optics/{name}.rs" for name in (
    "baselines bsdf fresnel ink lamp lamp_units lobes matter microfacet photometry quadrature relief slab "
    "refraction late shade spectrum study table through tier").split()]
# Mutants that a test only notices by never ending are caught too: shaders after LONGEST_S; Rust after
# so many times what the sound tests take, and LONGEST_MORE_S.
LONGEST_S = 600
# A build from nothing on a machine with other work.
LONGEST_BUILD_S = 7200
LONGEST_TIMES = 6
LONGEST_MORE_S = 20
# Others share the machine with a mutant that only gathers memory.
MOST_BYTES = 12 << 30
# In the order in which a mutant meets them.
TARGETS = [["--lib"], *(["--test", name] for name in ("parity", "tiers", "judged", "lobes", "matter"))]
# A minute long, and what it sees the others see earlier.
SLOW = ["the_gallery_tier_gives_back_all_light_and_no_more"]

TOKEN = re.compile(
    r"(?P<skip>//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])'|'[a-z_]+\b)"
    r"|(?P<word>[A-Za-z_][A-Za-z_0-9]*!?)"
    r"|(?P<number>(?:\d[\d_]*\.\d[\d_]*(?:e[+-]?\d+)?|\d[\d_]*\.(?![.\w])|\d[\d_]*e[+-]?\d+|\d[\d_]*)"
    r"(?:f32|f64|u32|i32|usize|u64|u|i|f)?)"
    r"|(?P<operator>->|=>|::|\.\.=?|&&|\|\||<<|>>|<=|>=|==|!=|[+\-*/]=|[+\-*/<>])"
    r"|(?P<other>[^\s])|(?P<space>\s+)", re.S)

SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=",
         "<": ">=", ">": "<=", "<=": ">", ">=": "<", "==": "!=", "!=": "==", "&&": "||",
         "||": "&&"}
CALLS = {"min": "max", "max": "min", "sin": "cos", "cos": "sin"}


def constant(text):
    """Another number of the same type, or None."""
    match = re.fullmatch(r"(.*?)(f32|f64|u32|i32|usize|u64|u|i|f)?", text)
    number, suffix = match.group(1).replace("_", ""), match.group(2) or ""
    if re.search(r"[.e]", number):
        value = float(number)
        # A tenth is more than any tolerance, and less than what is absurd.
        return f"{(value * 1.1 if value else 0.1)!r}{suffix}"
    return f"{int(number) + 1}{suffix}"


def without_tests(text):
    """Up to the tests, and with arrays of numbers blanked: same length as the text."""
    end = text.find("#[cfg(test)]")
    text = text if end < 0 else text[:end]
    table = re.compile(r"(?:const|static) \w+: \[[^=]*= \[\n.*?\n\];", re.S)
    return table.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)


def mutants(path):
    """(line, column, what, offset, old, new) of every mutant of a file."""
    text = (ROOT / path).read_text()
    code = without_tests(text) if path.endswith(".rs") else text
    found = []
    before = ""  # the last token that is no space
    generics = 0
    tokens = list(TOKEN.finditer(code))
    attribute = 0
    for i, match in enumerate(tokens):
        kind, token, at = match.lastgroup, match.group(), match.start()
        if kind in ("skip", "space"):
            continue
        after = next((m.group() for m in tokens[i + 1:] if m.lastgroup not in ("skip", "space")), "")
        # Attributes.
        if token == "#":
            attribute = -1
        elif attribute == -1 and token == "[":
            attribute = 1
        elif attribute > 0:
            attribute += {"[": 1, "]": -1}.get(token, 0)
            before = token
            continue
        new = None
        is_value = bool(re.match(r"[\w)\]]", before[-1:])) and before not in (
            "return", "in", "if", "else", "match", "let", "mut", "as")
        if kind == "number":
            # Places in arrays of fixed length, and types, are no constants of the physics.
            if not (generics or before == "." or (before == ";" and after == "]")):
                new = constant(token)
        elif kind == "word" and token in CALLS and after == "(":
            new = CALLS[token]
        elif kind == "operator" and token in SWAPS:
            opens = token == "<" and (
                before in ("array", "vec2", "vec3", "vec4", "ptr", "Vec", "Option", "Result", "Box",
                           "Arc", "::", "impl", "for", "fn", "HashMap", "BTreeMap", "Range",
                           "RangeInclusive", "RefCell") or (before[:1].isupper() and not
                                                            before.isupper()))
            if opens or (generics and token == "<"):
                generics += 1
            elif generics and token in (">", ">>"):
                generics -= len(token)
            elif token in "+-*/" and not is_value:
                if token == "-":
                    new = ""
                # Otherwise a reference or dereference.
            elif token in ("<", ">", "<=", ">=") or is_value or token in ("&&", "||", "==", "!="):
                if token == "||" and not is_value:
                    pass  # a closure without arguments
                else:
                    new = SWAPS[token]
        if new is not None:
            line = code.count("\n", 0, at) + 1
            column = at - code.rfind("\n", 0, at)
            found.append((path, line, column, at, token, new))
        before = token
    return found


def identity(mutant):
    path, line, column, _, old, new = mutant
    return f"{path}:{line}:{column}:{old}→{new or 'nothing'}"


def applied(mutant):
    path, _, _, at, old, new = mutant
    text = (ROOT / path).read_text()
    assert text[at:at + len(old)] == old, mutant
    return text[:at] + new + text[at + len(old):]


def generate(work, name="crate", level=1, laid=(), more=""):
    """The crate of the physics alone, optimised to `level`, but for the sources that are `laid` by
    others; `more` is in its library."""
    crate = work / name
    (crate / "bevy/src").mkdir(parents=True, exist_ok=True)
    (crate / "src/sheet").mkdir(parents=True, exist_ok=True)
    sources = [path for module in ("optics", "reference")
               for path in sorted((ROOT / "src" / module).rglob("*.rs"))]
    for source in [*sources, ROOT / "src/units.rs", ROOT / "src/colour.rs"]:
        path, text = str(source.relative_to(ROOT)), source.read_text()
        # Whole pictures need an exhibit and its maps; no test here asks for them.
        if path == "src/reference/mod.rs":
            text = re.sub(r"pub (mod|use) picture[^\n]*\n", "", text)
        if path not in laid and not path.startswith("src/reference/picture"):
            (crate / path).parent.mkdir(parents=True, exist_ok=True)
            write(crate / path, text)
    # What of the narrowing needs no manifest and no maps.
    uniform = (ROOT / "src/sheet/uniform.rs").read_text().split("/// Twin of `Paper`.")[0]
    uniform = re.sub(r" {4}manifest::\{\n.*?\n {4}\},\n| {4}(?:manifest|maps)::[^\n]*\n"
                     r"|mod media;\n|pub use media::[^\n]*\n", "", uniform, flags=re.S)
    write(crate / "src/sheet/uniform.rs", uniform)
    shaders = ROOT / "shaders"
    write(crate / "src/lib.rs", f'''
pub mod units; pub mod colour; pub mod optics; pub mod reference;
pub mod device {{
    #[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
    #[error("no graphics device")]
    pub struct NoDevice;
}}
pub mod sheet {{
    pub mod uniform;
    pub const PAPER_BSDF: &str = include_str!("{shaders}/paper_bsdf.wgsl");
    pub const PAPER_BASELINES: &str = include_str!("{shaders}/paper_baselines.wgsl");
    pub const PAPER_MEDIA: &str = include_str!("{shaders}/paper_media.wgsl");
}}
''' + more)
    write(crate / "bevy/src/lib.rs",
          "pub mod render { pub mod render_resource { pub use encase; pub use encase::ShaderType; } }\n")
    write(crate / "bevy/Cargo.toml", '''
[package]
name = "bevy"
version = "0.0.0"
edition = "2024"
[dependencies]
encase = "0.12"
''')
    tests = "".join(f'[[test]]\nname = "{name}"\npath = "{ROOT / path}"\n' for name, path in (
        ("tiers", "tests/physics/tiers.rs"), ("lobes", "tests/physics/lobes.rs"),
        ("matter", "tests/physics/matter.rs"), ("judged", "tests/judged.rs"),
        ("parity", "tests/parity.rs")))
    write(crate / "Cargo.toml", f'''
[package]
name = "recto"
version = "0.1.0"
edition = "2024"
[workspace]
[dependencies]
bevy = {{ path = "bevy" }}
encase = "0.12"
glam = {{ version = "0.32", features = ["encase"] }}
palette = {{ version = "0.7", default-features = false, features = ["std"] }}
pollster = "0.4"
rand = {{ version = "0.10", default-features = false }}
rand_distr = {{ version = "0.6", default-features = false }}
rayon = "1.12"
serde = {{ version = "1", features = ["derive"] }}
thiserror = "2"
wgpu = {{ version = "29", default-features = false, features = ["vulkan", "wgsl", "std", "parking_lot"] }}
{tests}
[profile.release]
opt-level = {level}
overflow-checks = true
incremental = true
debug = false
[profile.release.package."*"]
opt-level = 2
overflow-checks = false
''')
    shutil.copy(ROOT / "Cargo.lock", crate / "Cargo.lock")
    return crate


def write(path, text):
    """Leaves a file that is the same, with its date."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def environment(work):
    env = dict(os.environ, CARGO_TARGET_DIR=str(work / "target"))
    # The crate's own tests find the data beside the checkout.
    env.setdefault("RECTO_DATA", str(ROOT.parent / "shared/data"))
    # Ends a test binary with its first failure.
    env["RECTO_MUTANTS"] = str(work / "mutant")
    return env


def run(command, env, cwd, longest_s=LONGEST_S):
    """(exit code, output); 124 where it took too long."""
    try:
        done = subprocess.run(command, env=env, cwd=cwd, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=longest_s)
        return done.returncode, done.stdout.decode(errors="replace")
    except subprocess.TimeoutExpired:
        return 124, "it took too long"


def cargo(crate, env, target, *more):
    command = ["cargo", "test", "--release", "--offline", *target]
    return run([*command, *more], env, crate, LONGEST_BUILD_S)


def messages(output):
    """Cargo's."""
    return [json.loads(line) for line in output.splitlines() if line.startswith("{")]


def executable(crate, env, target):
    """Of a test, which is built, or None if it does not compile."""
    _, output = cargo(crate, env, target, "--no-run", "--message-format=json")
    name = "recto" if target == ["--lib"] else target[-1]
    for message in messages(output):
        if message.get("executable") and message["target"]["name"] == name:
            return message["executable"]
    return None


def until_a_failure(command, env, cwd, longest_s):
    """(exit code, output) of a test binary, which ends with its first failed test."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
    process = subprocess.Popen(command, env=env, cwd=cwd, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, preexec_fn=limit)
    late = threading.Event()
    timer = threading.Timer(longest_s, lambda: (late.set(), process.kill()))
    timer.start()
    output, failed = "", False
    for line in process.stdout:
        line = line.decode(errors="replace")
        output += line
        if re.match(r"test .*FAILED$", line.rstrip()):
            failed = True
            process.kill()
            break
    process.stdout.close()
    code = process.wait()
    timer.cancel()
    if late.is_set():
        return 124, "it took too long"
    return (101 if failed else code), output


def arguments_of(target):
    if target == ["--test", "parity"]:
        return ["--", "every_function_at_a_million_extremes", "--nocapture"]
    skips = [f"--skip={name}" for name in SLOW]
    return ["--", *skips]


PARITY = None


def judge_wgsl(mutant, work, crate, env):
    folder = work / "mutant"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / Path(mutant[0]).name).write_text(applied(mutant))
    global PARITY
    parity = ["--test", "parity"]
    PARITY = PARITY or executable(crate, env, parity) or sys.exit("tests/parity.rs was not built")
    code, output = run([PARITY, *arguments_of(parity)[1:]], env, crate)
    if code == 0:
        return "survived", ""
    if "Shader" in output and ("parsing error" in output or "Validation Error" in output
                               or "validation error" in output):
        return "invalid", ""
    return "caught", reason(output)


class Suite:
    """The tests against a crate."""

    def __init__(self, crate, env):
        self.crate, self.env = crate, env
        self.longest_s = {}

    def built(self, target):
        return executable(self.crate, self.env, target)

    def sound(self):
        """Takes the time of tests that all pass."""
        for target in TARGETS:
            binary = self.built(target)
            if not binary:
                sys.exit(f"{target[-1]} of the sound physics was not built")
            at = time.time()
            code, output = until_a_failure([binary, *arguments_of(target)[1:]], self.env, self.crate,
                                           LONGEST_S)
            if code != 0:
                sys.exit(f"the sound physics fails {target[-1]}:\n{output[-4000:]}")
            took = time.time() - at
            print(f"sound {target[-1]}: {took:.1f} s", flush=True)
            self.longest_s[target[-1]] = LONGEST_TIMES * took + LONGEST_MORE_S

    def judge(self, path, **more):
        """Of a mutant in `path`, whose own unit tests come first."""
        own = [f"optics::{Path(path).stem}::"]
        for target, only in [(["--lib"], own), *((target, []) for target in TARGETS)]:
            binary = self.built(target)
            if not binary:
                return "invalid", ""
            code, output = until_a_failure([binary, *only, *arguments_of(target)[1:]],
                                           {**self.env, **more}, self.crate,
                                           self.longest_s[target[-1]])
            if code != 0:
                return "caught", f"{target[-1]}: {reason(output)}"
        return "survived", ""


class Alone(Suite):
    """Compiles a mutant at a time."""

    def judged(self, mutant):
        path = self.crate / mutant[0]
        path.write_text(applied(mutant))
        try:
            return self.judge(mutant[0])
        finally:
            path.write_text((ROOT / mutant[0]).read_text())


class Switched(Suite):
    """All of `wanted` in one build, and which of them have their switch. `every` numbers them."""

    def __init__(self, work, env, wanted, every):
        self.paths = sorted({mutant[0] for mutant in wanted})
        super().__init__(generate(work, "switched", 2, self.paths, SWITCH), env)
        self.number = {identity(mutant): number for number, mutant in enumerate(every, 1)}
        self.wanted = wanted
        self.tool = work / "switches/debug/switches"
        code, output = run(["cargo", "build", "--offline"],
                           dict(env, CARGO_TARGET_DIR=str(work / "switches")),
                           ROOT / "tests/mutation/switches")
        if code != 0:
            sys.exit(output)
        # Known from an earlier build.
        known = work / "refused"
        names = known.read_text().split("\n") if known.exists() else []
        refused = {self.number[name] for name in names if name in self.number}
        while True:
            self.behind = self.lay(refused)
            more = self.refused()
            if not more:
                break
            if more <= refused:
                sys.exit(f"the compiler refuses more than switches, see {self.crate}")
            refused |= more
            known.write_text("\n".join(name for name, number in self.number.items()
                                       if number in refused))
            print(f"without a switch, as they do not compile behind one: {len(refused)}", flush=True)
        # Built once.
        self.binaries = {target[-1]: executable(self.crate, self.env, target) for target in TARGETS}

    def built(self, target):
        return self.binaries[target[-1]]

    def judged(self, mutant):
        return self.judge(mutant[0], RECTO_MUTANT=str(self.number[identity(mutant)]))

    def lay(self, refused):
        """Writes the sources with their switches; the numbers that have one."""
        behind = set()
        for path in self.paths:
            text = (ROOT / path).read_text()
            lines = []
            for mutant in self.wanted:
                number = self.number[identity(mutant)]
                if mutant[0] == path and number not in refused:
                    lines.append(f"{number}\t{len(text[:mutant[3]].encode())}\t{mutant[5]}\n")
            sites, switched = self.crate / "sites", self.crate / "switched.rs"
            sites.write_text("".join(lines))
            code, output = run([self.tool, ROOT / path, sites, switched], self.env, ROOT)
            if code != 0:
                sys.exit(f"{path}: {output}")
            write(self.crate / path, switched.read_text())
            behind |= {int(line) for line in output.split()}
        return behind

    def refused(self):
        """The innermost switches that the compiler's errors lie in; else those of the same lines,
        or of the same file."""
        code, output = cargo(self.crate, self.env, ["--lib"], "--no-run", "--message-format=json")
        if code == 0:
            return set()
        found = set()
        for message in messages(output):
            message = message.get("message") or {}
            if message.get("level") != "error":
                continue
            for span in message["spans"]:
                text = (self.crate / span["file_name"]).read_bytes()
                before = text[:span["byte_start"]].decode()
                inside = []
                for mark in re.finditer(r"/\*([<>])(\d+)\*/", before):
                    inside = inside + [int(mark[2])] if mark[1] == "<" else inside[:-1]
                if span["is_primary"] and inside:
                    found.add(inside[-1])
                    continue
                lines = text.decode().split("\n")[span["line_start"] - 1:span["line_end"]]
                near = {int(number) for number in re.findall(r"/\*<(\d+)\*/", "\n".join(lines))}
                if span["is_primary"]:
                    found |= near or {int(number) for number in
                                      re.findall(r"/\*<(\d+)\*/", text.decode())}
        if not found:
            sys.exit(output[-4000:])
        return found


# In the library of the crate with switches.
SWITCH = """
/// Whether it is the mutant that is judged.
#[inline(always)]
pub fn mutant(number: u32) -> bool {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    let read = || std::env::var("RECTO_MUTANT").map_or(0, |text| text.parse().expect("a number"));
    *CHOSEN.get_or_init(read) == number
}
"""


def reason(output):
    lines = [line for line in output.splitlines()
             if "panicked at" in line or "took too long" in line or line.endswith("FAILED")]
    return lines[0][:160] if lines else ""


def interval(caught, count):
    """Wilson's, 95%."""
    if count == 0:
        return 0.0, 1.0
    z = 1.959964
    share = caught / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return middle - half, middle + half


def judges(language, due, chosen, every, work, env):
    """(mutants, what judges each, whether several at a time) of all that are due of the chosen of
    all."""
    if not due:
        return
    if language == "wgsl":
        crate, parity = generate(work), ["--test", "parity"]
        code, output = cargo(crate, env, parity, *arguments_of(parity))
        if code != 0:
            sys.exit(f"the sound physics fails its shaders:\n{output[-4000:]}")
        yield due, lambda mutant: judge_wgsl(mutant, work, crate, env), False
        return
    # All that were chosen, so that a run which goes on finds them built.
    switched = Switched(work, env, chosen, every)
    behind = [mutant for mutant in due if switched.number[identity(mutant)] in switched.behind]
    print(f"{len(behind)} of {len(due)} have a switch", flush=True)
    switched.sound()
    yield behind, switched.judged, True
    others = [mutant for mutant in due if mutant not in behind]
    if others:
        alone = Alone(generate(work), env)
        alone.sound()
        yield others, alone.judged, False


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("language", choices=["wgsl", "rust"])
    parser.add_argument("--sample", type=int, metavar="N", help="that many, drawn at random")
    parser.add_argument("--seed", type=int, default=1, metavar="S")
    parser.add_argument("--work", type=Path)
    parser.add_argument("--list", action="store_true", help="name the mutants and run nothing")
    parser.add_argument("--again", action="store_true",
                        help="run the survivors of earlier runs again, after new tests")
    parser.add_argument("--minutes", type=float, help="begin no mutant after so long")
    parser.add_argument("--jobs", type=int, default=1, metavar="N",
                        help="judge so many of Rust at a time")
    arguments = parser.parse_args()
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    work = (arguments.work or target / "mutation").resolve()
    files = SHADERS if arguments.language == "wgsl" else SOURCES
    every = [mutant for path in files for mutant in mutants(path)]
    chosen = every
    if arguments.sample is not None:
        chosen = random.Random(arguments.seed).sample(every, min(arguments.sample, len(every)))
    if arguments.list:
        for mutant in chosen:
            print(identity(mutant))
        print(f"{len(chosen)} of {len(every)} mutants", file=sys.stderr)
        return
    work.mkdir(parents=True, exist_ok=True)
    results = work / f"{arguments.language}.csv"
    done = {}
    if results.exists():
        with results.open() as file:
            for row in csv.DictReader(file):
                done[row["mutant"]] = row
    else:
        results.write_text("mutant,outcome,reason,seconds\n")
    env = environment(work)
    shutil.rmtree(work / "mutant", ignore_errors=True)
    (work / "mutant").mkdir()
    begun = time.time()
    due = [mutant for mutant in chosen if identity(mutant) not in done
           or arguments.again and done[identity(mutant)]["outcome"] == "survived"]
    number = 0

    def timed(judge, mutant):
        at = time.time()
        if arguments.minutes and at - begun > 60 * arguments.minutes:
            return None
        return judge(mutant), time.time() - at

    for mutants_of, judge, several in judges(arguments.language, due, chosen, every, work, env):
        with ThreadPoolExecutor(arguments.jobs if several else 1) as pool:
            for mutant, judged in zip(mutants_of, pool.map(partial(timed, judge), mutants_of)):
                number += 1
                if judged is None:
                    continue
                (outcome, why), took = judged
                name = identity(mutant)
                row = {"mutant": name, "outcome": outcome, "reason": why, "seconds": f"{took:.1f}"}
                done[name] = row
                with results.open("a", newline="") as file:
                    csv.DictWriter(file, list(row)).writerow(row)
                print(f"{number}/{len(due)} {name}: {outcome} {why}", flush=True)
    rows = [done[identity(mutant)] for mutant in chosen if identity(mutant) in done]
    count = {outcome: sum(row["outcome"] == outcome for row in rows)
             for outcome in ("caught", "survived", "invalid")}
    judged = count["caught"] + count["survived"]
    low, high = interval(count["caught"], judged)
    print(f"{arguments.language}: {judged} of {len(every)} mutants judged "
          f"({count['invalid']} are no programs): {count['caught']} caught, "
          f"{100 * count['caught'] / max(judged, 1):.1f}% (95%: {100 * low:.1f} to {100 * high:.1f})")
    for row in rows:
        if row["outcome"] == "survived":
            print(f"survived: {row['mutant']}")


if __name__ == "__main__":
    main()
