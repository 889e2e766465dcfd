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
src/sheet/uniform.rs; its tests are the unit tests of optics, tests/physics/tiers.rs,
tests/judged.rs and tests/parity.rs. A mutant of a shader is laid in a folder that the tests' support
code reads (RECTO_MUTANTS) and needs no compiling. The first failure ends a mutant. One that does
not compile, or that the shader compiler refuses, does not count.

tests/mutation/survivors.md explains those that are left.
"""

import argparse
import csv
import json
import math
import os
import random
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHADERS = [f"shaders/paper_{name}.wgsl" for name in ("bsdf", "baselines", "media")]
# Not medium.rs and medium/catalogue.rs, which are data. Arrays of numbers are left out below.
SOURCES = [f"src/optics/{name}.rs" for name in (
    "baselines bsdf fresnel ink lamp lamp_units lobes matter microfacet photometry quadrature relief slab "
    "refraction late shade spectrum study table through tier").split()]
# Mutants that a test only notices by never ending are caught too.
LONGEST_S = 600
# A minute long, and what it sees the others see earlier.
SLOW = ["the_gallery_tier_gives_back_all_light_and_no_more", "bake"]

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


def generate(work):
    """The crate of the physics alone."""
    crate = work / "crate"
    (crate / "bevy/src").mkdir(parents=True, exist_ok=True)
    (crate / "src/sheet").mkdir(parents=True, exist_ok=True)
    for module in ("optics", "reference"):
        shutil.copytree(ROOT / "src" / module, crate / "src" / module, dirs_exist_ok=True)
    # Whole pictures need an exhibit and its maps; no test here asks for them.
    walk = (ROOT / "src/reference/mod.rs").read_text()
    write(crate / "src/reference/mod.rs", re.sub(r"pub (mod|use) picture[^\n]*\n", "", walk))
    shutil.rmtree(crate / "src/reference/picture", ignore_errors=True)
    for module in ("units", "colour"):
        shutil.copy(ROOT / f"src/{module}.rs", crate / f"src/{module}.rs")
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
''')
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
        ("tiers", "tests/physics/tiers.rs"), ("judged", "tests/judged.rs"),
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
oxilangtag = "0.1"
palette = {{ version = "0.7", default-features = false, features = ["std"] }}
pollster = "0.4"
rand = {{ version = "0.10", default-features = false }}
rand_distr = {{ version = "0.6", default-features = false }}
rayon = "1.12"
schemars = "1.2"
serde = {{ version = "1", features = ["derive"] }}
strsim = "0.11"
thiserror = "2"
wgpu = {{ version = "29", default-features = false, features = ["vulkan", "wgsl", "std", "parking_lot"] }}
[dev-dependencies]
proptest = "1.12"
{tests}
[profile.release]
opt-level = 1
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


def run(command, env, cwd):
    """(exit code, output); 124 where it took too long."""
    try:
        done = subprocess.run(command, env=env, cwd=cwd, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=LONGEST_S)
        return done.returncode, done.stdout.decode(errors="replace")
    except subprocess.TimeoutExpired:
        return 124, "it took too long"


def cargo(crate, env, target, *more):
    command = ["cargo", "test", "--release", "--offline", *target]
    return run([*command, *more], env, crate)


def executable(crate, env, target):
    """Of a built test."""
    _, output = cargo(crate, env, target, "--no-run", "--message-format=json")
    for line in output.splitlines():
        if line.startswith("{"):
            message = json.loads(line)
            if message.get("executable") and message["target"]["name"] == target[-1]:
                return message["executable"]
    sys.exit(f"cargo built no {target[-1]}:\n{output[-2000:]}")


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
    PARITY = PARITY or executable(crate, env, parity)
    code, output = run([PARITY, *arguments_of(parity)[1:]], env, crate)
    if code == 0:
        return "survived", ""
    if "Shader" in output and ("parsing error" in output or "Validation Error" in output
                               or "validation error" in output):
        return "invalid", ""
    return "caught", reason(output)


def judge_rust(mutant, work, crate, env):
    path = crate / mutant[0]
    sound = (ROOT / mutant[0]).read_text()
    path.write_text(applied(mutant))
    try:
        for target in (["--lib"], ["--test", "parity"], ["--test", "tiers"], ["--test", "judged"]):
            code, output = cargo(crate, env, target, "--no-run")
            if code != 0:
                return "invalid", ""
            code, output = cargo(crate, env, target, *arguments_of(target))
            if code != 0:
                return "caught", f"{target[-1]}: {reason(output)}"
        return "survived", ""
    finally:
        path.write_text(sound)


def reason(output):
    lines = [line for line in output.splitlines() if "panicked at" in line or "took too long" in line]
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
    crate, env = generate(work), environment(work)
    shutil.rmtree(work / "mutant", ignore_errors=True)
    (work / "mutant").mkdir()
    for target in (["--lib"], ["--test", "parity"], ["--test", "tiers"], ["--test", "judged"]):
        if arguments.language == "wgsl" and target != ["--test", "parity"]:
            continue
        code, output = cargo(crate, env, target, *arguments_of(target))
        if code != 0:
            sys.exit(f"the sound physics fails {target}:\n{output[-4000:]}")
    judge = judge_wgsl if arguments.language == "wgsl" else judge_rust
    begun = time.time()
    for number, mutant in enumerate(chosen):
        name = identity(mutant)
        if name in done and not (arguments.again and done[name]["outcome"] == "survived"):
            continue
        if arguments.minutes and time.time() - begun > 60 * arguments.minutes:
            break
        at = time.time()
        outcome, why = judge(mutant, work, crate, env)
        row = {"mutant": name, "outcome": outcome, "reason": why,
               "seconds": f"{time.time() - at:.1f}"}
        done[name] = row
        with results.open("a", newline="") as file:
            csv.DictWriter(file, list(row)).writerow(row)
        print(f"{number + 1}/{len(chosen)} {name}: {outcome} {why}", flush=True)
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
