"""The second engine beside PyTorch: full-size networks, 40 frames, one core, process CPU time.

    python -m venv ../inkrig-peers && ../inkrig-peers/bin/pip install -r benches/peers/requirements-generate.txt
    ../inkrig-peers/bin/python benches/peers/generate.py

Every round runs every workload once in each, so that a busy machine slows both alike; the table has the least CPU time of
all rounds. PyTorch gets the same shortcuts: masked frames are left out, nothing is recorded where no gradient is asked for, and
attention keeps no weights.
"""

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

for name in ["OMP", "OPENBLAS", "MKL"]:
    os.environ[f"{name}_NUM_THREADS"] = "1"

import torch
from torch import nn
from torch.nn import functional as F

ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEADS, WIDE, BLOCKS, FRAMES, FEATURES, TEXT = 256, 4, 1024, 9, 40, 263, 768
WORKLOADS = {
    "lcm2": "clip, LCM with 2 steps, without guidance",
    "evaluation": "one guidance evaluation",
    "ddim50": "clip, DDIM with 50 steps and weighted text",
    "decode": "decoding 40 frames",
    "denoiser": "denoiser, one sample",
    "trajectory": "trajectory encoder, 40 frames",
}


class Block(nn.Module):
    def __init__(self, memory):
        super().__init__()
        self.attention = nn.MultiheadAttention(WIDTH, HEADS, batch_first=True)
        self.memory = nn.MultiheadAttention(WIDTH, HEADS, batch_first=True) if memory else None
        self.widen, self.narrow = nn.Linear(WIDTH, WIDE), nn.Linear(WIDE, WIDTH)
        self.norms = nn.ModuleList(nn.LayerNorm(WIDTH) for _ in range(3 if memory else 2))

    def forward(self, x, memory=None):
        x = self.norms[0](x + self.attention(x, x, x, need_weights=False)[0])
        if self.memory is not None:
            x = self.norms[1](x + self.memory(x, memory, memory, need_weights=False)[0])
        return self.norms[-1](x + self.narrow(F.gelu(self.widen(x))))


class Stack(nn.Module):
    def __init__(self, blocks=BLOCKS, memory=False, skips=True):
        super().__init__()
        self.blocks = nn.ModuleList(Block(memory) for _ in range(blocks))
        self.joins = nn.ModuleList(nn.Linear(2 * WIDTH, WIDTH) for _ in range(blocks // 2 if skips else 0))
        self.norm = nn.LayerNorm(WIDTH)

    def forward(self, x, memory=None, residuals=None):
        half, skips, outputs = len(self.joins), [], []
        for at, block in enumerate(self.blocks):
            if half and at > half:
                x = self.joins[at - half - 1](torch.cat([x, skips.pop()], -1))
            x = block(x, memory)
            if residuals is not None:
                x = x + residuals[at]
            if at < half:
                skips.append(x)
            outputs.append(x)
        return self.norm(x), outputs


class Branch(nn.Module):
    def __init__(self):
        super().__init__()
        self.guidance = nn.Linear(WIDTH, TEXT, bias=False)
        self.time = nn.Sequential(nn.Linear(TEXT, WIDTH), nn.SiLU(), nn.Linear(WIDTH, WIDTH))
        self.text = nn.Sequential(nn.ReLU(), nn.Linear(TEXT, WIDTH))
        self.positions = nn.Parameter(torch.rand(3, WIDTH))
        self.stack = Stack()
        self.outputs = nn.ModuleList(nn.Linear(WIDTH, WIDTH) for _ in range(BLOCKS))
        self.condition = nn.Sequential(*(nn.Linear(WIDTH, WIDTH) for _ in range(3)))

    def forward(self, latents, t, texts, waves=None, residuals=None):
        steps = t * torch.exp(torch.arange(TEXT // 2) * (-9.21034 / (TEXT // 2)))
        time_waves = torch.cat([steps.cos(), steps.sin()])[None].expand(len(latents), -1)
        if waves is not None:
            time_waves = time_waves + self.guidance(waves)
        x = torch.stack([latents, self.time(time_waves), self.text(texts)], 1) + self.positions
        return self.stack(x, residuals=residuals)

    def corrections(self, *arguments, **named):
        outputs = self.forward(*arguments, **named)[1]
        return [output(block) for output, block in zip(self.outputs, outputs)]


class Encoder(nn.Module):
    def __init__(self, stack):
        super().__init__()
        self.embed, self.stack = nn.Linear(66, WIDTH), stack
        self.token, self.positions = nn.Parameter(torch.rand(1, WIDTH)), nn.Parameter(torch.rand(FRAMES + 1, WIDTH))

    def forward(self, rows):
        x = torch.cat([self.token, self.embed(rows)])[None]
        return self.stack(x + self.positions[: x.shape[1]])[0][:, 0]


class Peer(nn.Module):
    def __init__(self):
        super().__init__()
        self.base, self.adapter, self.control = Branch(), Branch(), Branch()
        self.trajectory, self.keypose = Encoder(Stack()), Encoder(Stack(6, skips=False))
        self.pose = nn.Linear(WIDTH, TEXT)
        self.decoder, self.queries = Stack(memory=True), nn.Parameter(torch.rand(1, FRAMES, WIDTH))
        self.last = nn.Linear(WIDTH, FEATURES)
        self.rows, self.key = torch.randn(FRAMES, 66), torch.randn(1, 66)
        self.texts, self.empty, self.waves = torch.randn(1, TEXT), torch.randn(1, TEXT), torch.randn(1, WIDTH)
        self.wanted, self.mask = torch.randn(FRAMES, 22, 2), torch.zeros(FRAMES, 22, 1)
        self.mask[:35, 10] = 1

    def decode(self, latents):
        return self.last(self.decoder(self.queries, latents[:, None])[0])

    def places(self, features):
        features = features * 0.1
        shifted = F.pad(features[:, :-1, :3], (0, 0, 1, 0))
        angle = 2 * shifted[..., 0].cumsum(1)
        sin, cos = angle.sin()[..., None], angle.cos()[..., None]

        def turn(x, z):
            return x * cos - z * sin, x * sin + z * cos

        x, z = (value.cumsum(1) for value in turn(shifted[..., 1:2], shifted[..., 2:3]))
        local = features[..., 4:67].unflatten(-1, (21, 3))
        turned = turn(local[..., 0], local[..., 2])
        joints = torch.stack([turned[0] + x, local[..., 1], turned[1] + z], -1)
        return torch.cat([torch.stack([x, features[..., 3:4], z], -1), joints], 2)

    def evaluation(self):
        latents = self.latent.requires_grad_()
        off = (self.places(self.decode(latents))[..., :2] - self.wanted) * self.mask
        return torch.autograd.grad((off**2).mean(), latents)

    def clip(self, steps, twice):
        embedding, pose = self.trajectory(self.rows), self.pose(F.relu(self.keypose(self.key)))
        waves = None if twice else self.waves
        latents = torch.randn(1, WIDTH)
        condition = self.control.condition(embedding)
        for t in torch.linspace(999, 1, steps):
            residuals = self.control.corrections(latents + condition, t, self.texts, waves)
            texts, both = self.texts, latents
            if twice:
                residuals = [torch.cat([r, torch.zeros_like(r)]) for r in residuals]
                texts, both = torch.cat([texts, self.empty]), latents.expand(2, -1)
            residuals = self.adapter.corrections(both, t, texts + pose, waves, residuals)
            noise = self.base(both, t, texts, waves, residuals)[0][:, 0]
            if twice:
                noise = noise[1:] + 7.5 * (noise[:1] - noise[1:])
            latents = 0.99 * latents - 0.01 * noise
        return self.decode(latents)

    def run(self, name):
        self.latent = torch.randn(1, WIDTH)
        before = time.process_time()
        if name == "evaluation":
            self.evaluation()
        else:
            with torch.inference_mode():
                {
                    "lcm2": lambda: self.clip(2, False),
                    "ddim50": lambda: self.clip(50, True),
                    "decode": lambda: self.decode(self.latent),
                    "denoiser": lambda: self.base(self.latent, torch.tensor(999.0), self.texts),
                    "trajectory": lambda: self.trajectory(self.rows),
                }[name]()
        return 1e3 * (time.process_time() - before)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--binary", help="the built example `generation_speed`; built now if not given")
    arguments = parser.parse_args()
    torch.manual_seed(0)
    torch.set_num_threads(1)
    peer = Peer().eval().requires_grad_(False)
    binary = arguments.binary
    if not binary:
        subprocess.run(["cargo", "build", "--release", "-p", "inkrig-generate", "--example", "generation_speed"], cwd=ROOT, check=True)
        binary = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/examples/generation_speed"
    ours = subprocess.Popen([binary, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    if not ours.stdout.readline():
        sys.exit("the example `generation_speed` said nothing: see its message above")

    def ask(name):
        ours.stdin.write(name + "\n")
        ours.stdin.flush()
        return float(ours.stdout.readline())

    least = {name: [float("inf")] * 2 for name in WORKLOADS}
    for round in range(arguments.rounds + 1):
        for name in WORKLOADS:
            for at, run in enumerate([ask, peer.run]):
                taken = run(name)
                # The first round warms caches.
                if round:
                    least[name][at] = min(least[name][at], taken)
    ours.stdin.close()
    ours.wait()
    print(f"PyTorch {torch.__version__}\n")
    print("| milliseconds of CPU | inkrig | PyTorch | ratio |\n|---|---|---|---|")
    for name, said in WORKLOADS.items():
        mine, theirs = least[name]
        print(f"| {said} | {mine:.1f} | {theirs:.1f} | {mine / theirs:.2f} |")


main()
