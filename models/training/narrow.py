#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Narrows the last head of a trained network, a quarter of the network's time, to the hidden channels that its logits need most.

usage: narrow.py CHECKPOINT.pt OUT.pt DIR ... --head 256 --size 640x480 [--images 140]

Channels are chosen one after the other, each the one that explains most of what those before it leave of the logits (orthogonal
matching pursuit, Pati et al., Asilomar 1993), over images of the data's training part; the logits are then fitted anew to the chosen
ones by least squares. Places of rare classes weigh more. Go on with train.py --from OUT.pt --head 256.
"""
import argparse

import numpy as np
import torch

from dataset import LabelledFolder, resized
from network_file import load_network, normalise, save_checkpoint
from train import parse_size

PLACES = 500    # of each image's logits, and half as many of it at half the size
RAREST = 1e-3   # share of the places below which a class weighs no more
RIDGE = 1e-6    # of each channel's own square sum: two channels may be nearly the same


def hidden_and_logits(model, images, size, rng):
    """@param images  HxWx3 uint8 arrays  @return N x hidden channels, N x classes, float64: at places drawn at random"""
    inputs, outputs = [], []
    hook = model.head[-1].register_forward_hook(lambda _, given, result: (inputs.append(given[0]), outputs.append(result)))
    with torch.no_grad():
        for image in images:
            for part in (1, 2):
                before = len(inputs)
                model(normalise(resized(image, None, (size[0] // part, size[1] // part))[0][None]))
                for kept in (inputs, outputs):
                    kept[before] = kept[before][0].flatten(1).T
                places = torch.from_numpy(rng.permutation(len(inputs[before]))[:PLACES // part])
                inputs[before], outputs[before] = inputs[before][places], outputs[before][places]
    hook.remove()
    return torch.cat(inputs).double(), torch.cat(outputs).double()


def choose(gram, cross, count):
    """@param gram  C x C, sums of products of the channels  @param cross  C x K, of channels and logits
    @return indices of `count` channels in rising order, chosen after the last one, which stands for the constant"""
    own, gram, cross = torch.diag(gram).clone(), gram.clone(), cross.clone()
    chosen = [len(gram) - 1]
    while True:
        last = gram[:, chosen[-1]].clone()
        pivot = last[chosen[-1]].clone()
        cross -= torch.outer(last, cross[chosen[-1]]) / pivot
        gram -= torch.outer(last, last) / pivot
        if len(chosen) > count:
            return sorted(chosen[1:])
        left = torch.diag(gram)
        gain = cross.square().sum(1) / left.clamp(min=1e-12)
        gain[left <= 1e-4 * own] = -1  # the chosen ones explain it; and it itself, once chosen
        chosen.append(int(gain.argmax()))


def narrow(weights, hidden, logits, width):
    """Changes a checkpoint's weights. @return root mean square error of the logits over the places"""
    shares = torch.bincount(logits.argmax(1), minlength=logits.shape[1]).double() / len(logits)
    weight = shares.clamp(min=RAREST)[logits.argmax(1)].rsqrt()[:, None]
    inputs = torch.cat((hidden, torch.ones(len(hidden), 1, dtype=hidden.dtype)), 1)
    gram, cross = inputs.T @ (weight * inputs), inputs.T @ (weight * logits)
    kept = torch.tensor(choose(gram, cross, width))
    fitted = torch.cat((kept, torch.tensor([len(gram) - 1])))
    gram = gram[fitted][:, fitted]
    solution = torch.linalg.solve(gram + RIDGE * torch.diag(torch.diag(gram)), cross[fitted])
    for name in ('head.0.0.weight', *(f'head.0.1.{part}' for part in ('weight', 'bias', 'running_mean', 'running_var'))):
        weights[name] = weights[name][kept]
    weights['head.2.weight'] = solution[:-1].T.float()[:, :, None, None].contiguous()
    weights['head.2.bias'] = solution[-1].float()
    return (inputs[:, fitted] @ solution - logits).square().mean().sqrt().item()


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('checkpoint')
    parser.add_argument('out')
    parser.add_argument('data', nargs='+', help='labelled folders')
    parser.add_argument('--head', type=int, required=True, help='hidden channels that are left')
    parser.add_argument('--size', type=parse_size, required=True, help='of the input, px; half of it is looked at too')
    parser.add_argument('--images', type=int, default=140, help='as many of each folder')
    args = parser.parse_args(argv)
    model, checkpoint = load_network(args.checkpoint)
    if args.head >= checkpoint['head_channels']:
        raise SystemExit(f"'{args.checkpoint}' has a head of {checkpoint['head_channels']} channels; --head must be less")
    folders = [LabelledFolder(folder).split(held_back=False).first(-(-args.images // len(args.data))) for folder in args.data]
    images = (folder.load(index).image for folder in folders for index in range(len(folder)))
    hidden, logits = hidden_and_logits(model, images, args.size, np.random.default_rng(1))
    error = narrow(checkpoint['average'], hidden, logits, args.head)
    save_checkpoint(args.out, average=checkpoint['average'], head_channels=args.head, size=args.size, step=checkpoint['step'])
    print(f'{args.out}: {args.head} of {checkpoint["head_channels"]} channels; logits differ by {error:.3f} where they spread by '
          f'{logits.std().item():.2f}')


if __name__ == '__main__':
    main()
