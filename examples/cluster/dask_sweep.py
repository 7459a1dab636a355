#!/usr/bin/env python3
"""Runs the parts of a sweep as tasks of Dask, then merges them.

    python3 dask_sweep.py SPEC.toml DIR --parts 4 [--workers 2 | --scheduler HOST:PORT]

Without a scheduler, so many worker processes are started on this machine. Workers of a scheduler need the
same files, and `cullscope` on their path or in the variable CULLSCOPE.
"""

import argparse
import os
import subprocess
from pathlib import Path

from distributed import Client, LocalCluster, as_completed


def program():
    return os.environ.get("CULLSCOPE", "cullscope")


def run_part(spec, folder, part, parts):
    out = Path(folder) / f"part-{part}"
    call = [program(), "sweep", spec, "--shard", f"{part}/{parts}", "--out", str(out)]
    if (out / "log.jsonl").exists():
        call.append("--resume")
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip())
    return str(out)


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("spec")
    words.add_argument("folder")
    words.add_argument("--parts", type=int, default=4)
    words.add_argument("--workers", type=int, default=2)
    words.add_argument("--scheduler")
    args = words.parse_args()
    Path(args.folder).mkdir(parents=True, exist_ok=True)
    if args.scheduler:
        client = Client(args.scheduler)
    else:
        # Processes with one thread each: a part is timed on a core of its own.
        cluster = LocalCluster(n_workers=args.workers, threads_per_worker=1, processes=True, dashboard_address=None)
        client = Client(cluster)
    with client:
        parts = range(1, args.parts + 1)
        tasks = [client.submit(run_part, args.spec, args.folder, part, args.parts, pure=False) for part in parts]
        for task in as_completed(tasks):
            print(task.result(), flush=True)
    folders = [str(Path(args.folder) / f"part-{part}") for part in parts]
    merged = Path(args.folder) / "all"
    subprocess.run([program(), "sweep", "merge", *folders, "--out", str(merged)], check=True)


if __name__ == "__main__":
    main()
