#!/usr/bin/python3
"""The controller on the emulated Cortex-M7, and whether `pil` would notice if something were wrong.   pil_test.py BUILD OUT"""
import importlib.machinery
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD, OUT = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
PIL = ROOT / "firmware/cortex_m/pil"
SCENARIOS = ["light/dry_asphalt", "medium_a/wet_asphalt", "heavy/dry_cobblestone"]

shutil.rmtree(OUT, ignore_errors=True)
only = [word for name in SCENARIOS for word in ("--only", name)]
good = subprocess.run([PIL, "--build", BUILD, "--out", OUT, *only], text=True, capture_output=True)
print(good.stdout, good.stderr)

# [CTL-120] The host's bytes; [CTL-120] within every limit.
assert good.returncode == 0
results = json.loads((OUT / "results.json").read_text())
figures = results["figures"]
assert figures["scenarios"] == len(SCENARIOS) and figures["differing"] == 0
assert figures["frames"] > figures["steps"] > 15_000, "a valve command answers every period"
assert 500 < figures["step_mean_instructions"] <= figures["step_worst_instructions"] <= results["limits"]["step_worst_instructions"]
assert figures["step_worst_instructions"] < figures["period_worst_instructions"]
# The bound over all calls and what was seen in memory are two ways to the same stack; the latter has the harness on top.
assert 100 < figures["stack_bytes"] < figures["stack_painted_bytes"] + 512

# [CTL-120] A limit that is passed is named, and ends with status 1.
loader = importlib.machinery.SourceFileLoader("pil", str(PIL))
pil = importlib.util.module_from_spec(importlib.util.spec_from_loader("pil", loader))
sys.dont_write_bytecode = True
loader.exec_module(pil)
sys.argv = ["pil", "--build", str(BUILD), "--out", str(OUT), "--only", SCENARIOS[0]]
pil.LIMITS["step_worst_instructions"] = 100
assert pil.main() == 1

# [CTL-120] One rounding less (a multiply and an add in one instruction) shows.
pil.LIMITS["step_worst_instructions"] = 2500
pil.FLAGS[pil.FLAGS.index("-ffp-contract=off")] = "-ffp-contract=fast"
assert pil.main() == 1, "a controller that rounds otherwise went unnoticed"

# [CTL-120] A heap in the image is refused.
heap = OUT / "heap.elf"
source = OUT / "heap.cpp"
source.write_text("#include <cstdlib>\nvoid* volatile kept;\nextern \"C\" void _exit(int) { for (;;) {} }\n"
                  "extern \"C\" void* _sbrk(int) { return nullptr; }\nint main() { kept = std::malloc(8); }\n")
pil.run("arm-none-eabi-g++", "-mcpu=cortex-m7", "-mthumb", "--specs=nano.specs", "--specs=nosys.specs", source, "-o", heap)
try:
    pil.no_heap(heap)
except pil.Failed as failure:
    assert "malloc" in str(failure)
else:
    raise SystemExit("a heap went unnoticed")

# [CTL-120] Nonsense is refused by name.
bad = subprocess.run([PIL, "--build", BUILD, "--out", OUT, "--only", "heavy/mud"], text=True, capture_output=True)
assert bad.returncode == 2 and "heavy/mud" in bad.stderr
log = OUT / "not.log"
log.write_text("(0.000000) vcan0 100#0011\n(0.001000) vcan0 10x#00\n")
bad = subprocess.run([BUILD / "firmware/cortex_m/cortex-m-prepare", "--out", OUT / "made", log], text=True, capture_output=True, cwd=ROOT)
assert bad.returncode == 2 and "not.log:2" in bad.stderr, bad.stderr
