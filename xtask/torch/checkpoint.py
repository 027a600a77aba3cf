"""Checkpoints as PyTorch writes them, and whether an import kept every bit.

    checkpoint.py write NAMES.tsv FOLDER     whole.ckpt, legacy.pt, harmful.ckpt with random numbers
    checkpoint.py compare FILE.ckpt FILE.safetensors
"""

import collections
import json
import os
import sys

import torch


def write(names, folder):
    torch.manual_seed(0)
    weights = collections.OrderedDict()
    for line in open(names, encoding="utf-8"):
        name, shape = line.rstrip("\n").split("\t")
        weights[name] = torch.randn([int(axis) for axis in shape.split(",")]) * 0.02
    # What training frameworks leave in such files: parameters, tables in another order in memory, counters.
    weights["vae.encoder.norm.weight"] = torch.nn.Parameter(weights["vae.encoder.norm.weight"])
    turned = "controlnet.emb_proj.1.weight"
    weights[turned] = weights[turned].t().contiguous().t()
    weights["vae.something.num_batches_tracked"] = torch.tensor(3)
    weights._metadata = {"": {"version": 1}}
    moments = {"state": {0: {"step": torch.tensor(1.0), "exp_avg": torch.zeros(4)}}, "param_groups": [{"lr": 1e-4}]}
    whole = {"epoch": 3, "global_step": 10**12, "state_dict": weights, "optimizer_states": [moments]}
    torch.save(whole, os.path.join(folder, "whole.ckpt"))
    torch.save(dict(weights), os.path.join(folder, "legacy.pt"), _use_new_zipfile_serialization=False)

    class Harmful:
        def __reduce__(self):
            return (os.system, ("echo harmed > " + os.path.join(folder, "harmed"),))

    torch.save({"state_dict": weights, "more": Harmful()}, os.path.join(folder, "harmful.ckpt"))


def compare(checkpoint, imported):
    weights = torch.load(checkpoint, weights_only=True)
    weights = weights.get("state_dict", weights)
    with open(imported, "rb") as file:
        size = int.from_bytes(file.read(8), "little")
        header = json.loads(file.read(size))
        body = bytearray(file.read())
    header.pop("__metadata__", None)
    missing = [name for name in weights if name not in header and "num_batches" not in name]
    if missing or not header:
        sys.exit(f"{len(missing)} tensors are missing, the first: {missing[:3]}")
    for name, entry in header.items():
        first, last = entry["data_offsets"]
        if entry["dtype"] != "F32":
            sys.exit(f"{name} is {entry['dtype']}")
        numbers = torch.frombuffer(body, dtype=torch.float32, count=(last - first) // 4, offset=first)
        if not torch.equal(numbers.reshape(entry["shape"]), weights[name].detach()):
            sys.exit(f"{name} differs")
    count = sum(tensor.numel() for name, tensor in weights.items() if name in header)
    print(f"{len(header)} tensors, {count} numbers: every bit is there")


if __name__ == "__main__":
    {"write": write, "compare": compare}[sys.argv[1]](*sys.argv[2:])
