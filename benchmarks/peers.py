"""The renderers that peer_cycles.py compares: each renders one view and tells the seconds of rendering alone."""

import json
import os
import pathlib
import re
import resource
import shutil
import subprocess


class PeerError(Exception):
    pass


def run(command):
    result = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if result.returncode != 0:
        raise PeerError(result.stderr.strip() or f"{command[0]} ended with exit code {result.returncode}")
    return result.stdout


def processor_seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def processor_seconds(process):
    """Of one that runs."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def compare(wavepath, picture, reference):
    """The metrics of `wavepath compare`, the same for all renderers."""
    return json.loads(run([wavepath, "compare", picture, reference, "--json"]))


class Wavepath:
    name = "wavepath"

    def __init__(self, binary, view):
        self.binary = binary
        self.flags = []  # besides those of the view
        self.version = run([binary, "--version"]).strip()
        self.device = None

        def triple(v):
            return ",".join(str(x) for x in v)

        self.command = [binary, "render", view["scene"], "--size", "{}x{}".format(*view["size"]),
                        "--eye", triple(view["eye"]), "--look-at", triple(view["look_at"]), "--yfov", view["yfov"],
                        "--max-depth", view["max_depth"], "--filter", "box", "--json", "-q"]
        if view["environment"]:
            self.command += ["--env", view["environment"], "--env-intensity", view["intensity"]]

    def render(self, spp, seed, output):
        before = processor_seconds_of_children()
        stats = json.loads(run(self.command + self.flags + ["--spp", spp, "--seed", seed, "-o", output]))
        self.device = stats["device"]
        pilots = sum(decision["render_seconds"] for decision in stats["plan"])
        return {"seconds": stats["seconds"]["render"] + pilots, "mrays_per_second": stats["mrays_per_second"],
                "processor": processor_seconds_of_children() - before}


class Cycles:
    """One Blender that keeps the scene and renders on demand, so that it starts once."""

    name = "cycles"
    driver = pathlib.Path(__file__).with_name("cycles_driver.py")

    def __init__(self, blender, view, log):
        self.log = open(log, "w")
        # Blender takes its Python packages from beside the first python3 in PATH: let that be its own distribution's.
        own = pathlib.Path(shutil.which(blender)).parent
        environment = dict(os.environ, PATH=f"{own}{os.pathsep}{os.environ['PATH']}")
        command = [blender, "-b", "--factory-startup", "--debug-cycles", "--python-exit-code", "1", "-P",
                   str(self.driver)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True, env=environment)
        self.version = self.ask(view)[-1].removeprefix("DONE ").strip()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait()
        self.log.close()

    def ask(self, job):
        self.process.stdin.write(json.dumps(job) + "\n")
        self.process.stdin.flush()
        lines = []
        for line in self.process.stdout:
            self.log.write(line)
            lines.append(line)
            if line.startswith("DONE"):
                return lines
        raise PeerError("Blender ended: " + "".join(lines[-4:]).strip())

    def render(self, spp, seed, output):
        before = processor_seconds(self.process)
        told = "".join(self.ask({"spp": spp, "seed": seed, "output": str(output.resolve())}))
        return {"seconds": float(re.search(r"Render time \(without synchronization\): ([\d.]+)", told).group(1)),
                "processor": processor_seconds(self.process) - before}
