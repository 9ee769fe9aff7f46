#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trains BiSeNet V2 on labelled folders. Stop it with Ctrl-C and run it again: it goes on where it stopped.

usage: train.py --data DIR[:WEIGHT] ... --out DIR [--steps 20000] [--size 320x256] ...

Of every folder a fifth is held back (by a hash of the image names) and scored now and then. OUT gets last.pt (all that is
needed to go on), best.pt (best mean IoU so far), log.csv and curve.png. Runs on a GPU where PyTorch finds one.
"""
import argparse
import copy
import csv
import os

import torch
import torch.nn.functional as F

import scores
from bisenetv2 import BiSeNetV2, resize
from classes import IGNORE, NAMES
from dataset import AugmentedSamples, LabelledFolder
from network_file import load_checkpoint, normalise, save_checkpoint
from progress import Bar, plot_curve

LOG_FIELDS = ('step', 'loss', 'mean_iou', 'person_iou')


def parse_size(text):
    try:
        width, height = (int(side) for side in text.split('x'))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' must be WIDTHxHEIGHT") from None
    if width < 64 or height < 64 or width % 32 or height % 32:
        raise argparse.ArgumentTypeError(f"'{text}': both sides must be multiples of 32, 64 or more")
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
    parser.add_argument('--size', type=parse_size, default=(320, 256), help="of samples and of the network's input, px")
    parser.add_argument('--steps', type=int, default=20000)
    parser.add_argument('--batch', type=int, default=16)
    parser.add_argument('--rate', type=float, default=2e-3, help='peak learning rate of AdamW')
    parser.add_argument('--head', type=int, default=128, help='hidden channels of the last head; 1024 as published')
    parser.add_argument('--paste', type=float, default=0.5, help='share of samples that cutouts are pasted into')
    parser.add_argument('--evaluate-every', type=int, default=1000, help='steps')
    parser.add_argument('--workers', type=int, default=1, help='processes that make samples')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--bfloat16', action='store_true', help='mixed precision, where the processor is faster with it')
    return parser.parse_args(argv)


def hard_pixel_loss(logits, label):
    """Cross entropy over the hard pixels: those whose true class has a probability below 0.7, and at least a sixteenth of
    all (online hard example mining, as the paper trains)."""
    loss = F.cross_entropy(resize(logits, label.shape[1:]).float(), label, ignore_index=IGNORE, reduction='none').flatten()
    hardest = loss.topk(max(1, loss.numel() // 16)).values
    threshold = torch.minimum(hardest[-1], loss.new_tensor(0.3567))  # -ln 0.7
    hard = loss[loss > threshold]
    return hard.mean() if hard.numel() else hardest.mean()


def total_loss(model, images, labels):
    logits, boosters = model(normalise(images))
    return sum((hard_pixel_loss(b, labels) for b in boosters), hard_pixel_loss(logits, labels))


def learning_rate(step, steps, peak):
    """Linear warm-up over the first twentieth, then the polynomial decay of the paper."""
    warm_up = max(1, min(1000, steps // 20))
    if step < warm_up:
        return peak * (step + 1) / warm_up
    return peak * (1 - (step - warm_up) / max(1, steps - warm_up)) ** 0.9


class Training:
    def __init__(self, args):
        self.args = args
        self.device = 'cuda' if torch.cuda.is_available() else 'cpu'
        torch.manual_seed(args.seed)
        self.model = BiSeNetV2(len(NAMES), args.head).to(self.device)
        self.average = copy.deepcopy(self.model).eval()  # the weights' running mean infers better than the last ones
        self.optimiser = torch.optim.AdamW(self.model.parameters(), args.rate, weight_decay=5e-4)
        self.step, self.best = 0, -1.0
        os.makedirs(args.out, exist_ok=True)
        self.last = os.path.join(args.out, 'last.pt')
        self.log = os.path.join(args.out, 'log.csv')
        if os.path.exists(self.last):
            self._resume()
        else:
            self._write_log(LOG_FIELDS, 'w')

    def _resume(self):
        saved = load_checkpoint(self.last)
        if saved['head_channels'] != self.args.head or tuple(saved['size']) != tuple(self.args.size):
            raise SystemExit(f"'{self.last}' was trained with another --head or --size; take another --out")
        self.model.load_state_dict(saved['model'])
        self.average.load_state_dict(saved['average'])
        self.optimiser.load_state_dict(saved['optimiser'])
        self.step, self.best = saved['step'], saved['best']

    def save(self, path):
        save_checkpoint(path, model=self.model.state_dict(), average=self.average.state_dict(),
                        optimiser=self.optimiser.state_dict(), step=self.step, best=self.best, size=self.args.size,
                        head_channels=self.args.head)

    def _write_log(self, row, mode='a'):
        with open(self.log, mode, newline='', encoding='utf-8') as out:
            csv.writer(out).writerow(row)

    def one_step(self, images, labels):
        self.model.train()
        for group in self.optimiser.param_groups:
            group['lr'] = learning_rate(self.step, self.args.steps, self.args.rate)
        images, labels = images.to(self.device), labels.to(self.device).long()
        with torch.autocast(self.device, torch.bfloat16, enabled=self.args.bfloat16):
            loss = total_loss(self.model, images, labels)
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), 5.0)
        self.optimiser.step()
        self.step += 1
        self._update_average()
        return loss.item()

    def _update_average(self):
        keep = min(0.999, self.step / (self.step + 20))
        with torch.no_grad():
            for mean, now in zip(self.average.state_dict().values(), self.model.state_dict().values()):
                if mean.dtype.is_floating_point:
                    mean.mul_(keep).add_(now, alpha=1 - keep)
                else:
                    mean.copy_(now)

    def score(self, folders, loss):
        iou = scores.evaluate(self.average, folders, self.args.size, self.device)
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
    held_back = [folder for folder in (LabelledFolder(folder).split(held_back=True) for folder, _ in args.data) if len(folder)]
    samples = AugmentedSamples(sources, args.size, args.steps * args.batch, args.seed, args.paste)
    rest = torch.utils.data.Subset(samples, range(training.step * args.batch, len(samples)))
    loader = torch.utils.data.DataLoader(rest, args.batch, num_workers=args.workers, persistent_workers=args.workers > 0)
    print(f"{sum(len(f) for f, _ in sources)} images to train on, {sum(len(f) for f in held_back)} held back; "
          f'{training.device}, from step {training.step}')
    bar, losses, scored = Bar(args.steps, training.step), [], ''
    for images, labels in loader:
        losses.append(training.one_step(images, labels))
        loss = sum(losses) / len(losses)  # since the last score
        if training.step % args.evaluate_every == 0 or training.step == args.steps:
            scored = ', mean IoU %.3f, person %.3f' % training.score(held_back, loss)
            training.save(training.last)
            plot_curve(training.log, os.path.join(args.out, 'curve.png'))
            losses = []
        bar.update(training.step, f'loss {loss:.3f}{scored}')
    return training


if __name__ == '__main__':
    main()
