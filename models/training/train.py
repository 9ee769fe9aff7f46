#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trains BiSeNet V2 on labelled folders. Stop it with Ctrl-C and run it again: it goes on where it stopped.

usage: train.py --data DIR[:WEIGHT] ... --out DIR [--steps 20000 | --minutes 60] [--size 256x192] ...

Of every folder a fifth is held back (by a hash of the image names) and scored now and then. OUT gets last.pt (all that is
needed to go on), best.pt (best mean IoU so far), log.csv and curve.png. Runs on a GPU where PyTorch finds one, and computes
in bfloat16 where the processor is faster with it. `torchrun --nproc-per-node 2 train.py ...` takes as many processes, each with
batches and steps of its own, and their weights are averaged every few steps (Stich, "Local SGD Converges Fast and
Communicates Little", ICLR 2019). On a processor that is faster than as many threads.
"""
import argparse
import copy
import csv
import math
import os
import re
import time

import cv2
import torch
import torch.distributed as distributed
import torch.nn.functional as F

import scores
from bisenetv2 import BiSeNetV2, resize
from classes import IGNORE, NAMES
from dataset import AugmentedSamples, LabelledFolder
from network_file import load_checkpoint, load_weights, normalise, read_weights, save_checkpoint, widths
from progress import Bar, plot_curve

LOG_FIELDS = ('step', 'loss', 'mean_iou', 'person_iou')
LOSS_STRIDE = 2      # px of the label image per pixel of the loss: at full size it costs as much as the network
TRANSFERRED = 'semantic.', 'coarse.'  # what the public network brings
CONTEXT_RATE = 0.03  # of the rate, for what else comes with features that stay as they are
SMALL = ('keyboard', 'mouse', 'bottle', 'cup')
CLASS_WEIGHTS = [1.0 if name in ('background', 'person') else 2.0 if name in SMALL else 1.5 for name in NAMES]  # the rarer, the more
SHARE_EVERY = 5      # steps between averages of the processes' weights
SAVE_EVERY = 100     # steps
SCORED_IMAGES = 40   # of a folder's held-back fold while training; evaluate.py takes all


def parse_size(text):
    try:
        width, height = (int(side) for side in text.split('x'))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' must be WIDTHxHEIGHT") from None
    if width < 64 or height < 64 or width % 16 or height % 16:
        raise argparse.ArgumentTypeError(f"'{text}': both sides must be multiples of 16, 64 or more")
    return width, height


def parse_source(text):
    """DIR or DIR:WEIGHT."""
    folder, colon, weight = text.rpartition(':')
    try:
        return (folder, float(weight)) if colon else (text, 1.0)
    except ValueError:
        return text, 1.0


def arguments(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--data', type=parse_source, nargs='+', required=True, help='labelled folders, with :WEIGHT')
    parser.add_argument('--out', required=True)
    parser.add_argument('--from', dest='start', metavar='FILE',
                        help='begin a new training with the weights of this checkpoint, network of export.py, or public network '
                             '(ready_network.py), which brings the semantic branch alone')
    parser.add_argument('--size', type=parse_size, nargs='+', default=[(256, 192)], metavar='WIDTHxHEIGHT',
                        help='of samples, px; several take turns, step by step, and the first is that of the scores')
    parser.add_argument('--steps', type=int, default=20000)
    parser.add_argument('--minutes', type=float, help='length of the training, instead of --steps')
    parser.add_argument('--batch', type=int, default=8)
    parser.add_argument('--rate', type=float, default=2e-3, help='peak learning rate of AdamW')
    parser.add_argument('--train-features', action='store_true',
                        help="have the semantic branch's features learn too; without --from they do anyway")
    parser.add_argument('--head', type=int, help='hidden channels of the last head; those of --from, or 1024 as published, otherwise')
    parser.add_argument('--paste', type=float, default=0.33,
                        help='share of samples that cutouts are pasted into; twice as many of those that show nobody')
    parser.add_argument('--evaluate-every', type=int, default=1000, help='steps')
    parser.add_argument('--workers', type=int, default=1, help='processes that make samples')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--threads', type=int, help="PyTorch's, on a processor; as many as it has cores otherwise")
    parser.add_argument('--compile', action='store_true',
                        help='have PyTorch 2 compile the network first: some minutes, then a third faster (needs a C++ compiler)')
    parser.add_argument('--precision', choices=('auto', 'float32', 'bfloat16'), default='auto')
    return parser.parse_args(argv)


def processes():
    return int(os.environ.get('WORLD_SIZE', 1))  # torchrun's


def rank():
    return int(os.environ.get('RANK', 0))


def mean_of_processes(tensor):
    if processes() > 1:
        distributed.all_reduce(tensor)
        tensor /= processes()
    return tensor


def computes_bfloat16(device):
    """Whether the device multiplies matrices of bfloat16 in hardware."""
    if device == 'cuda':
        return torch.cuda.is_bf16_supported()
    try:
        with open('/proc/cpuinfo', encoding='ascii') as text:
            return re.search(r'\b(amx_bf16|avx512_bf16)\b', text.read()) is not None
    except OSError:
        return False


def hard_pixel_loss(logits, label, stride=1):
    """Cross entropy, weighted by class, over the hard pixels: those that lose as much as a true class of weight 1 and
    probability 0.7, and at least a sixteenth of all (online hard example mining, as the paper trains).

    @param stride  takes every so many-th pixel of the label image, in both directions"""
    label = label[:, stride // 2::stride, stride // 2::stride]
    loss = F.cross_entropy(resize(logits.float(), label.shape[1:]), label, logits.new_tensor(CLASS_WEIGHTS, dtype=torch.float32),
                           ignore_index=IGNORE, reduction='none').flatten()
    hardest = loss.topk(max(1, loss.numel() // 16)).values
    threshold = torch.minimum(hardest[-1], loss.new_tensor(0.3567))  # -ln 0.7
    hard = loss[loss > threshold]
    return hard.mean() if hard.numel() else hardest.mean()


def learning_rate(progress, peak):
    """Linear warm-up over the first twentieth, then half a cosine to 0. @param progress  0 to 1"""
    if progress < 0.05:
        return peak * max(progress, 0.002) / 0.05
    return peak * 0.5 * (1 + math.cos(math.pi * min(1.0, (progress - 0.05) / 0.95)))


def adamw(model, rate, keeps_features):
    """In one pass over all weights where PyTorch can: their many small tensors take a tenth of a step otherwise.

    @param keeps_features  those of the semantic branch stay, and the context's layers learn at CONTEXT_RATE"""
    model.semantic.features.requires_grad_(not keeps_features)
    named = [(name, p) for name, p in model.named_parameters() if p.requires_grad]
    groups = [{'params': [p for name, p in named if name.startswith(TRANSFERRED) == transferred], 'share': share}
              for transferred, share in ((False, 1.0), (True, CONTEXT_RATE if keeps_features else 1.0))]
    try:
        return torch.optim.AdamW(groups, rate, weight_decay=5e-4, fused=True)
    except (RuntimeError, TypeError):  # before PyTorch 2.4, on a processor
        return torch.optim.AdamW(groups, rate, weight_decay=5e-4)


class Training:
    def __init__(self, args):
        self.args = args
        self.device = 'cuda' if torch.cuda.is_available() else 'cpu'
        if processes() > 1:
            distributed.init_process_group('nccl' if self.device == 'cuda' else 'gloo')
            if self.device == 'cuda':
                torch.cuda.set_device(int(os.environ['LOCAL_RANK']))
        torch.manual_seed(args.seed)
        cv2.setNumThreads(1)  # samples are made by processes
        if args.threads:
            torch.set_num_threads(args.threads)
        self.bfloat16 = args.precision == 'bfloat16' or (args.precision == 'auto' and computes_bfloat16(self.device))
        os.makedirs(args.out, exist_ok=True)
        self.last = os.path.join(args.out, 'last.pt')
        self.log = os.path.join(args.out, 'log.csv')
        resumes = os.path.exists(self.last)
        begins_with = self.last if resumes else args.start
        weights = read_weights(begins_with) if begins_with else {}
        part = all(name.startswith(TRANSFERRED) for name in weights)  # the public network's, or none
        width = {'head_channels': args.head or 1024} if part else widths(weights, begins_with)
        if args.head not in (None, width['head_channels']):
            raise SystemExit(f"'{begins_with}' has {width['head_channels']} channels in its last head, not {args.head}; leave --head out")
        saved = load_checkpoint(self.last) if resumes else {}
        self.keeps_features = saved.get('keeps_features', bool(weights) and not args.train_features)
        self.model = BiSeNetV2(len(NAMES), **width)
        self.model = self.model.to(self.device, memory_format=torch.channels_last)  # the faster layout nearly everywhere
        if args.compile and not hasattr(torch, 'compile'):
            raise SystemExit(f'--compile needs PyTorch 2; this is {torch.__version__}')
        self.compiled = torch.compile(self.model, dynamic=False) if args.compile else self.model
        self.optimiser = adamw(self.model, args.rate, self.keeps_features)
        self.step, self.best, self.seconds = 0, -1.0, 0.0
        self.unshared_seconds = 0.0
        if part:
            self.model.load_state_dict(weights, strict=False)
        elif not resumes:
            load_weights(self.model, weights, args.start)
        self.average = copy.deepcopy(self.model).eval()  # the weights' running mean infers better than the last ones
        if resumes:
            self._resume(saved)
        elif rank() == 0:
            self._write_log(LOG_FIELDS, 'w')

    def _resume(self, saved):
        self.model.load_state_dict(saved['model'])
        self.average.load_state_dict(saved['average'])
        self.optimiser.load_state_dict(saved['optimiser'])
        self.step, self.best, self.seconds = saved['step'], saved['best'], saved['seconds']

    def save(self, path):
        save_checkpoint(path, model=self.model.state_dict(), average=self.average.state_dict(),
                        optimiser=self.optimiser.state_dict(), step=self.step, best=self.best, seconds=self.seconds,
                        size=self.args.size[0], keeps_features=self.keeps_features)

    def progress(self):
        """@return how much of the training is done, 0 to 1"""
        if self.args.minutes:
            return min(1.0, self.seconds / 60 / self.args.minutes)
        return min(1.0, self.step / self.args.steps)

    def _write_log(self, row, mode='a'):
        with open(self.log, mode, newline='', encoding='utf-8') as out:
            csv.writer(out).writerow(row)

    def one_step(self, images, labels):
        start = time.monotonic()
        self.model.train()
        for group in self.optimiser.param_groups:
            group['lr'] = group['share'] * learning_rate(self.progress(), self.args.rate)
        images = images.to(self.device, memory_format=torch.channels_last)
        labels = labels.to(self.device).long()
        with torch.autocast(self.device, torch.bfloat16, enabled=self.bfloat16):
            loss = hard_pixel_loss(self.compiled(normalise(images)), labels, LOSS_STRIDE)
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), 5.0)
        self.optimiser.step()
        self.step += 1
        self._update_average()
        self.unshared_seconds += time.monotonic() - start
        if self.step % SHARE_EVERY == 0:
            self._share()
        return loss.item()

    def _share(self):
        """The time too, so that all processes end at the same step."""
        self.seconds += mean_of_processes(torch.tensor(self.unshared_seconds, device=self.device)).item()
        self.unshared_seconds = 0.0
        if processes() == 1:
            return
        shared = [t for t in self.model.state_dict().values() if t.dtype.is_floating_point]
        means = mean_of_processes(torch.cat([t.flatten() for t in shared]))
        for tensor, mean in zip(shared, means.split([t.numel() for t in shared])):
            tensor.copy_(mean.view_as(tensor))

    def _update_average(self):
        keep = min(0.998, self.step / (self.step + 20))
        with torch.no_grad():
            for mean, now in zip(self.average.state_dict().values(), self.model.state_dict().values()):
                if mean.dtype.is_floating_point:
                    mean.mul_(keep).add_(now, alpha=1 - keep)
                else:
                    mean.copy_(now)

    def score(self, folders, loss):
        iou = scores.evaluate(self.average, folders, self.args.size[0], self.device)
        mean = scores.mean_iou(iou)
        self._write_log((self.step, f'{loss:.4f}', f'{mean:.4f}', f"{iou.get('person', 0.0):.4f}"))
        if mean > self.best:
            self.best = mean
            self.save(os.path.join(self.args.out, 'best.pt'))
        return mean, iou.get('person', 0.0)


def main(argv=None):
    args = arguments(argv)
    training = Training(args)
    sources = [(LabelledFolder(folder).split(held_back=False), weight) for folder, weight in args.data]
    folds = (LabelledFolder(folder).split(held_back=True) for folder, _ in args.data)
    held_back = [fold.first(SCORED_IMAGES) for fold in folds if len(fold)]
    count = 10**9 if args.minutes else args.steps * args.batch * processes()
    samples = AugmentedSamples(sources, args.size, count, args.seed, args.paste, args.batch * processes())
    rest = torch.utils.data.Subset(samples, range(training.step * args.batch * processes() + rank(), count, processes()))
    loader = torch.utils.data.DataLoader(rest, args.batch, num_workers=args.workers, persistent_workers=args.workers > 0)
    if rank() == 0:
        print(f"{sum(len(f) for f, _ in sources)} images to train on, {sum(len(f) for f in held_back)} held back and scored; "
              f"{training.device} x {processes()}, {'bfloat16' if training.bfloat16 else 'float32'}, from step {training.step}")
    run(training, loader, held_back)
    return training


def run(training, loader, held_back):
    args, losses, scored = training.args, [], ''
    bar = Bar(training.progress()) if rank() == 0 else None
    for images, labels in loader:
        if training.progress() >= 1:
            break
        losses.append(training.one_step(images, labels))
        if rank() != 0:
            continue
        loss = sum(losses) / len(losses)  # since the last score
        if training.step % args.evaluate_every == 0 or training.progress() >= 1:
            scored = ', mean IoU %.3f, person %.3f' % training.score(held_back, loss)
            training.save(training.last)
            plot_curve(training.log, os.path.join(args.out, 'curve.png'))
            losses = []
        elif training.step % SAVE_EVERY == 0:
            training.save(training.last)
        bar.update(training.progress(), f'step {training.step} loss {loss:.3f}{scored}')


if __name__ == '__main__':
    main()
