"""The unit tests of both rooms, built from a copy of the project in which the rooms' files are rewritten (sites.py)."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORK = ROOT / "build/mutation"
TREE = WORK / "tree"
ROOMS = ("firmware/control", "firmware/can")


def link(source, target):
    if not target.is_symlink():
        target.symlink_to(source)


def write(target, text):
    """Only if it is another text, so that nothing is compiled in vain."""
    if not target.exists() or target.read_text() != text:
        target.write_text(text)


def rewrite():
    """Every mutant, and the files they are in; the rewritten ones are in TREE, whose other files are links."""
    # Here, since `--help` has to work where python3-clang is not installed.
    import clang.cindex as clang
    import sites

    mutants, rewriters = [], {}
    for room in ROOMS:
        for path in sorted((ROOT / room).glob("*.[ch]pp")):
            rewriters[str(path)] = sites.Rewriter(path, f"{room}/{path.name}", mutants)
    index = clang.Index.create()
    for path in [p for p in rewriters if p.endswith(".cpp")]:
        unit = index.parse(path, args=["-std=c++20", f"-I{ROOT}", '-DANTISKID_VERSION="0"'])
        for problem in unit.diagnostics:
            if problem.severity >= clang.Diagnostic.Error:
                sys.exit(f"mutate: clang cannot read {path}: {problem}")
        sites.visit(unit.cursor, [], rewriters)

    (TREE / "firmware").mkdir(parents=True, exist_ok=True)
    for entry in ROOT.iterdir():
        if entry.name not in ("build", "out", "firmware", ".git"):
            link(entry, TREE / entry.name)
    for entry in (ROOT / "firmware").iterdir():
        if f"firmware/{entry.name}" not in ROOMS:
            link(entry, TREE / "firmware" / entry.name)
    for room in ROOMS:
        (TREE / room).mkdir(exist_ok=True)
        for gone in {p.name for p in (TREE / room).iterdir()} - {p.name for p in (ROOT / room).iterdir()}:
            (TREE / room / gone).unlink()
        link(ROOT / room / "CMakeLists.txt", TREE / room / "CMakeLists.txt")
    for path, rewriter in rewriters.items():
        write(TREE / pathlib.Path(path).relative_to(ROOT), rewriter.rewritten())
    return mutants, [pathlib.Path(p) for p in sorted(rewriters)]


def test_sources():
    return sorted(p for folder in ("tests/control", "tests/can", "tests/mutation") for p in (ROOT / folder).iterdir() if p.suffix in (".cpp", ".hpp", ".txt")
                  and p.name not in ("equivalent.txt", "open.txt", "known.txt"))


def programs(jobs):
    """The test programs, built."""
    made = WORK / "made"
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    # An operation behind a call is of another constness and range to the compiler: what it warns of, or refuses as narrowing, is the tool's.
    configure = ["cmake", "-G", "Ninja", "-S", TREE, "-B", made, *launcher, "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_UNITY_BUILD=ON",
                 "-DCMAKE_UNITY_BUILD_BATCH_SIZE=0", "-DCMAKE_CXX_FLAGS=-w -fpermissive -D_GLIBCXX_ASSERTIONS", "-DCMAKE_CXX_FLAGS_DEBUG=-O1"]
    for name, command in (("configure", configure), ("build", ["cmake", "--build", made, "-j", str(jobs), "--target", "coverage_tests"])):
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=dict(os.environ, CCACHE_BASEDIR=str(ROOT), CCACHE_NOHASHDIR="1"))
        if done.returncode != 0:
            sys.exit(f"mutate: {name} of the rewritten sources fails:\n{(done.stdout + done.stderr)[-6000:]}")
    query = subprocess.run(["ninja", "-C", str(made), "-t", "query", "tests/coverage_tests"], capture_output=True, text=True, check=True).stdout
    return [made / p for p in sorted(set(re.findall(r"\btests/\w+/test_\w+", query)))]
