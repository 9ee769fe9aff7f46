#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Narrows a trained network where it is wide at most cost: the last head, what it reads, and the detail branch, most of all its
first convolutions.

usage: narrow.py CHECKPOINT.pt OUT.pt DIR ... --size 640x480 [--head 256] [--aggregated 96] [--detail 24 24] [--images 120]

Of a convolution's channels those are kept that the next one needs most (He, Zhang and Sun, "Channel Pruning for Accelerating Very
Deep Neural Networks", ICCV 2017), here chosen one after the other, each the one that explains most of what those before it leave of
the next one's output (orthogonal matching pursuit, Pati et al., Asilomar 1993), at random places of the data's training part. The
next one's weights are then fitted anew by least squares. Export OUT.pt, or go on with train.py --from OUT.pt.
"""
import argparse

import numpy as np
import torch
import torch.nn.functional as F

from bisenetv2 import DETAIL_CHANNELS
from dataset import LabelledFolder, resized
from network_file import load_network, network_of, normalise, save_checkpoint
from train import parse_size

PLACES = 400    # of each image's output, and half as many of it at half the size
RAREST = 1e-3   # share of the places below which a class weighs no more: rare ones weigh more in the logits
RIDGE = 1e-6    # of each channel's own square sum: two channels may be nearly the same


def patches_and_outputs(narrow, wide, name, images, size, rng):
    """What a convolution of the narrowed network reads, and what the wide one makes of it, at places drawn at random.

    @param name  of the convolution  @param images  HxWx3 uint8 arrays
    @return N x channels * kernel's area, N x outputs, float64"""
    seen = {}
    part = 'detail' if name.startswith('detail') else ''
    hooks = [network.get_submodule(name).register_forward_hook(
        lambda _, given, result, network=network: seen.update({network: (given[0], result)})) for network in (narrow, wide)]
    conv = narrow.get_submodule(name)
    kernel, stride = conv.kernel_size[0], conv.stride[0]
    patches, outputs = [], []
    for image in images:
        for scale in (1, 2):
            tensor = normalise(resized(image, None, (size[0] // scale, size[1] // scale))[0][None])
            with torch.no_grad():
                for network in (narrow, wide):
                    network.get_submodule(part)(tensor)
            given, wanted = seen[narrow][0], seen[wide][1][0]
            padded = F.pad(given, [kernel // 2] * 4)[0]
            v, u = (torch.from_numpy(rng.integers(0, side, PLACES // scale)) for side in wanted.shape[1:])
            patch = [padded[:, v * stride + dv, u * stride + du] for dv in range(kernel) for du in range(kernel)]
            patches.append(torch.stack(patch, 1).flatten(0, 1).T)
            outputs.append(wanted[:, v, u].T)
    for hook in hooks:
        hook.remove()
    return torch.cat(patches).double(), torch.cat(outputs).double()


def choose(gram, cross, area, count):
    """@param gram   sums of products of the inputs, `area` consecutive ones for each channel
    @param cross  of inputs and outputs  @return `count` channels in rising order"""
    channels = len(gram) // area
    ridge = RIDGE * torch.diag(gram).reshape(channels, area).diag_embed() + 1e-9 * torch.eye(area, dtype=gram.dtype)
    every = torch.arange(channels)
    chosen = []
    while len(chosen) < count:
        own = gram.reshape(channels, area, channels, area)[every, :, every] + ridge
        left = cross.reshape(channels, area, -1)
        gain = (left * torch.linalg.solve(own, left)).sum((1, 2))
        gain[chosen] = -1
        best = int(gain.argmax())
        chosen.append(best)
        rows = slice(best * area, (best + 1) * area)
        explained = gram[:, rows] @ torch.linalg.solve(own[best], torch.cat((gram[rows], cross[rows]), 1))
        gram, cross = gram - explained[:, :len(gram)], cross - explained[:, len(gram):]
    return sorted(chosen)


def fit(patches, outputs, weight, area, count):
    """@param weight  N x 1, of the places  @return kept channels; outputs x kept inputs, and outputs: least squares' weights and bias"""
    mean_in, mean_out = ((weight * x).sum(0) / weight.sum() for x in (patches, outputs))
    patches, outputs = patches - mean_in, outputs - mean_out
    gram, cross = patches.T @ (weight * patches), patches.T @ (weight * outputs)
    kept = torch.tensor(choose(gram, cross, area, count))
    inputs = (kept[:, None] * area + torch.arange(area)).flatten()
    gram = gram[inputs][:, inputs]
    solution = torch.linalg.solve(gram + torch.diag(RIDGE * torch.diag(gram) + 1e-9), cross[inputs]).T
    return kept, solution, mean_out - solution @ mean_in[inputs]


def narrow_layer(weights, wide, layer, reader, count, images, size):
    """Keeps `count` channels of a convolution with normalisation, for the convolution that reads them. Changes weights."""
    narrow = network_of(weights, 'the narrowed network')
    patches, outputs = patches_and_outputs(narrow, wide, reader, images, size, np.random.default_rng(1))
    weight = torch.ones(len(outputs), 1, dtype=outputs.dtype)
    if reader == 'head.2':
        shares = torch.bincount(outputs.argmax(1), minlength=outputs.shape[1]).double() / len(outputs)
        weight = shares.clamp(min=RAREST)[outputs.argmax(1)].rsqrt()[:, None]
    conv = narrow.get_submodule(reader)
    kept, solution, bias = fit(patches, outputs, weight, conv.kernel_size[0] ** 2, count)
    for name in (f'{layer}.0.weight', *(f'{layer}.1.{part}' for part in ('weight', 'bias', 'running_mean', 'running_var'))):
        weights[name] = weights[name][kept]
    weights[f'{reader}.weight'] = solution.float().reshape(len(solution), count, *conv.kernel_size).contiguous()
    if conv.bias is not None:
        weights[f'{reader}.bias'] = bias.float()
    else:
        weights[f'{reader[:-1]}1.running_mean'] = weights[f'{reader[:-1]}1.running_mean'] - bias.float()  # of its normalisation


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('checkpoint')
    parser.add_argument('out')
    parser.add_argument('data', nargs='+', help='labelled folders')
    parser.add_argument('--head', type=int, help='hidden channels of the last head that are left')
    parser.add_argument('--aggregated', type=int, help='channels that are left of what the last head reads')
    parser.add_argument('--detail', type=int, nargs='+', default=[], metavar='N',
                        help="channels that are left of the detail branch's first convolutions, up to seven numbers")
    parser.add_argument('--size', type=parse_size, required=True, help='of the input, px; half of it is looked at too')
    parser.add_argument('--images', type=int, default=120, help='as many of each folder')
    args = parser.parse_args(argv)
    wanted = [(f'detail.{k}', f'detail.{k + 1}.0', count) for k, count in enumerate(args.detail)]
    wanted += [('aggregate.fuse', 'head.0.0', args.aggregated), ('head.0', 'head.2', args.head)]
    wanted = [row for row in wanted if row[2] is not None]
    if not wanted:
        parser.error('nothing to narrow: give --head, --aggregated or --detail')
    if args.images < 1:
        parser.error(f'--images must be 1 or more, not {args.images}')
    if len(args.detail) >= len(DETAIL_CHANNELS):
        parser.error(f'--detail takes up to {len(DETAIL_CHANNELS) - 1} numbers, not {len(args.detail)}')
    wide, checkpoint = load_network(args.checkpoint)
    weights = checkpoint['average']
    folders = [LabelledFolder(folder).split(held_back=False).first(-(-args.images // len(args.data))) for folder in args.data]
    images = [folder.load(index).image for folder in folders for index in range(len(folder))]
    for layer, reader, count in wanted:
        has = len(weights[f'{layer}.0.weight'])
        if not 0 < count <= has:
            raise SystemExit(f"'{args.checkpoint}' has {has} channels in {layer}, of which {count} cannot be kept; take fewer")
        if count < has:
            narrow_layer(weights, wide, layer, reader, count, images, args.size)
        print(f'{layer}: {count} of {has} channels kept')
    save_checkpoint(args.out, average=weights, size=args.size, step=checkpoint['step'])


if __name__ == '__main__':
    main()
