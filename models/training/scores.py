# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Intersection over union per class; precision and recall of people, and how much is taken for people where nobody is."""
import numpy as np
import torch

from bisenetv2 import resize
from classes import IGNORE, NAMES, PERSON
from dataset import resized
from network_file import normalise


class Confusion:
    def __init__(self):
        self.counts = np.zeros((len(NAMES), len(NAMES)), np.int64)  # true class, predicted class
        self.empty = []  # of each image whose truth shows nobody: share that is taken for a person, also where the truth is unknown

    def add(self, truth, predicted):
        """@param truth, predicted  label images of one size"""
        known = truth != IGNORE
        pairs = truth[known].astype(np.int64) * len(NAMES) + predicted[known]
        self.counts += np.bincount(pairs, minlength=len(NAMES) ** 2).reshape(self.counts.shape)
        if not (truth == PERSON).any():
            self.empty.append(float((predicted == PERSON).mean()))

    def iou(self):
        """@return {class: IoU}; classes that neither truth nor prediction shows are left out."""
        both = np.diag(self.counts)
        either = self.counts.sum(0) + self.counts.sum(1) - both
        return {name: both[i] / either[i] for i, name in enumerate(NAMES) if either[i] > 0}

    def people(self):
        """@return precision and recall, over pixels; 1 where there are none to be wrong about"""
        right = self.counts[PERSON, PERSON]
        called, true = self.counts[:, PERSON].sum(), self.counts[PERSON].sum()
        return tuple(float(right / count) if count else 1.0 for count in (called, true))

    def false_people(self):
        """@return mean share of the images without people that is taken for people; None without such images"""
        return float(np.mean(self.empty)) if self.empty else None


def mean_iou(iou):
    """Over the classes that were seen, background left out."""
    seen = [value for name, value in iou.items() if name != 'background']
    return float(np.mean(seen)) if seen else 0.0


def predict(model, image, size, shape, device='cpu'):
    """@return label image of `shape` for one RGB image, from logits up-sampled bilinearly, as at run time."""
    tensor, _ = resized(image, None, size)
    logits = model(normalise(tensor[None].to(device)))
    return resize(logits, shape).argmax(1)[0].byte().cpu().numpy()


def evaluate(model, folders, size, device='cpu', on_image=None):
    """@param folders  [LabelledFolder]  @return {class: IoU} over all their images."""
    return confusion_of(model, folders, size, device, on_image).iou()


def confusion_of(model, folders, size, device='cpu', on_image=None):
    """@return the Confusion over all images of the folders"""
    model.eval()
    confusion = Confusion()
    with torch.no_grad():
        for folder in folders:
            for index in range(len(folder)):
                image, label = folder.load(index)[:2]
                predicted = predict(model, image, size, label.shape, device)
                confusion.add(label, predicted)
                if on_image:
                    on_image(folder.pairs[index][0], image, predicted)
    return confusion
