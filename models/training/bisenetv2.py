# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""BiSeNet V2 (Yu et al., "BiSeNet V2: Bilateral Network with Guided Aggregation for Real-time Semantic Segmentation",
International Journal of Computer Vision 129, 2021), written from the paper. Table and figure numbers are the paper's."""
import torch
from torch import nn
import torch.nn.functional as F

from classes import PERSON

DETAIL_CHANNELS = (64, 64, 64, 64, 64, 128, 128, 128)  # of the detail branch's convolutions, S1-S3, table 1
DETAIL_STRIDES = (2, 1, 2, 1, 1, 2, 1, 1)
SEMANTIC_CHANNELS = (16, 32, 64, 128)   # stem, S3, S4, S5 of the semantic branch, table 1
EXPANSION = 6                           # of gather-and-expansion
AUX_HEAD_CHANNELS = 128
EDGE_CELLS = 1                          # of TwoScales
TRAINING_HEADS = ('boosters.', 'hints.')


class Conv(nn.Conv2d):
    """On a processor, bfloat16 is the slower choice for convolutions by groups: a tenth of float32's speed at stride 2."""

    def forward(self, x):
        if self.groups == 1 or x.dtype != torch.bfloat16 or x.device.type != 'cpu':
            return super().forward(x)
        with torch.autocast('cpu', enabled=False):
            return super().forward(x.float()).to(x.dtype)


def conv_bn(inputs, outputs, kernel=3, stride=1, groups=1, relu=True):
    layers = [Conv(inputs, outputs, kernel, stride, kernel // 2, groups=groups, bias=False),
              nn.BatchNorm2d(outputs)]
    return nn.Sequential(*layers, nn.ReLU(inplace=True)) if relu else nn.Sequential(*layers)


def depthwise(inputs, outputs, stride=1):
    """3x3 depth-wise convolution with batch normalisation; outputs is a multiple of inputs."""
    return conv_bn(inputs, outputs, 3, stride, groups=inputs, relu=False)


class DetailBranch(nn.Sequential):
    """Wide and shallow: spatial detail at 1/8. @param channels  of its eight convolutions"""

    def __init__(self, channels):
        inputs = (3, *channels[:-1])
        super().__init__(*[conv_bn(i, o, stride=stride) for i, o, stride in zip(inputs, channels, DETAIL_STRIDES)])


class Stem(nn.Module):
    """Two ways to shrink, by convolution and by pooling, fused; figure 4 (a). Output at 1/4."""

    def __init__(self, channels):
        super().__init__()
        self.first = conv_bn(3, channels, stride=2)
        self.convolved = nn.Sequential(conv_bn(channels, channels // 2, 1), conv_bn(channels // 2, channels, stride=2))
        self.pooled = nn.MaxPool2d(3, stride=2, padding=1)
        self.fuse = conv_bn(2 * channels, channels)

    def forward(self, image):
        x = self.first(image)
        return self.fuse(torch.cat((self.convolved(x), self.pooled(x)), dim=1))


class GatherExpansion(nn.Module):
    """Gather-and-expansion layer, figure 5 (b) at stride 1 and (c) at stride 2."""

    def __init__(self, inputs, outputs, stride=1):
        super().__init__()
        wide = EXPANSION * inputs
        expand = [depthwise(inputs, wide, stride)]
        if stride == 2:
            expand.append(depthwise(wide, wide))
        else:
            expand.append(nn.ReLU(inplace=True))
        self.body = nn.Sequential(conv_bn(inputs, inputs), *expand, conv_bn(wide, outputs, 1, relu=False))
        self.shortcut = nn.Identity() if stride == 1 else nn.Sequential(
            depthwise(inputs, inputs, stride), conv_bn(inputs, outputs, 1, relu=False))

    def forward(self, x):
        return F.relu(self.body(x) + self.shortcut(x))


class ContextEmbedding(nn.Module):
    """Adds the image's mean feature to every place, figure 4 (b)."""

    def __init__(self, channels):
        super().__init__()
        self.norm = nn.BatchNorm2d(channels)
        self.project = conv_bn(channels, channels, 1)
        self.fuse = conv_bn(channels, channels)

    def forward(self, x):
        context = self.project(self.norm(x.mean(dim=(2, 3), keepdim=True)))
        return self.fuse(x + context)


class SemanticBranch(nn.Module):
    """Narrow and deep: context at 1/32. @return its four stages, for the booster heads."""

    def __init__(self):
        super().__init__()
        stem, c3, c4, c5 = SEMANTIC_CHANNELS
        self.stem = Stem(stem)
        self.stage3 = nn.Sequential(GatherExpansion(stem, c3, 2), GatherExpansion(c3, c3))
        self.stage4 = nn.Sequential(GatherExpansion(c3, c4, 2), GatherExpansion(c4, c4))
        self.stage5 = nn.Sequential(GatherExpansion(c4, c5, 2), *[GatherExpansion(c5, c5) for _ in range(3)])
        self.context = ContextEmbedding(c5)

    def forward(self, image):
        s2 = self.stem(image)
        s3 = self.stage3(s2)
        s4 = self.stage4(s3)
        s5 = self.stage5(s4)
        return s2, s3, s4, s5, self.context(s5)


class GuidedAggregation(nn.Module):
    """Each branch gates the other at its own scale, figure 6. @param outputs  channels, as many as `channels` as published"""

    def __init__(self, channels, outputs):
        super().__init__()

        def separable():
            return nn.Sequential(depthwise(channels, channels), nn.Conv2d(channels, channels, 1, bias=False))

        self.detail_keep = separable()
        self.detail_down = nn.Sequential(conv_bn(channels, channels, stride=2, relu=False),
                                         nn.AvgPool2d(3, stride=2, padding=1))
        self.semantic_up = conv_bn(channels, channels, relu=False)
        self.semantic_keep = separable()
        self.fuse = conv_bn(channels, outputs, relu=False)

    def forward(self, detail, semantic):
        size = detail.shape[2:]
        gate = torch.sigmoid(resize(self.semantic_up(semantic), size))
        fine = self.detail_keep(detail) * gate
        coarse = self.detail_down(detail) * torch.sigmoid(self.semantic_keep(semantic))
        return self.fuse(fine + resize(coarse, size))


class Head(nn.Sequential):
    """Logits at the resolution of its input."""

    def __init__(self, inputs, hidden, classes):
        super().__init__(conv_bn(inputs, hidden), nn.Dropout2d(0.1), nn.Conv2d(hidden, classes, 1))


def resize(x, size):
    return F.interpolate(x, size=[int(size[0]), int(size[1])], mode='bilinear', align_corners=False)


class BiSeNetV2(nn.Module):
    """@param classes        logits per pixel
    @param head_channels  hidden width of the last head: 1024 as published; it is a third of all weights and a quarter of
                          the time, so that a network for few classes does with less
    @param boosters       the four heads on the semantic branch that training needs (figure 2); not counted at inference
    @param hints          numbers that two more heads predict while training, from the aggregated features and from the
                          context (hints.py); not part of the paper, not counted at inference
    @param detail         channels of the detail branch's convolutions, the last as published; narrow.py takes some away
    @param aggregated     channels that the last head reads; likewise

    In:  N x 3 x H x W, normalised, H and W multiples of 32.
    Out: logits N x classes x H/8 x W/8; in training mode with boosters (logits, [four more at 1/4, 1/8, 1/16, 1/32],
         [N x hints at 1/8 and at 1/32]).
    """

    def __init__(self, classes, head_channels=1024, boosters=True, hints=0, detail=DETAIL_CHANNELS,
                 aggregated=DETAIL_CHANNELS[-1]):
        super().__init__()
        self.detail = DetailBranch(detail)
        self.semantic = SemanticBranch()
        self.aggregate = GuidedAggregation(DETAIL_CHANNELS[-1], aggregated)
        self.head = Head(aggregated, head_channels, classes)
        self.boosters = nn.ModuleList(
            [Head(channels, AUX_HEAD_CHANNELS, classes) for channels in SEMANTIC_CHANNELS] if boosters else [])
        self.hints = nn.ModuleList(
            [nn.Conv2d(channels, hints, 1) for channels in (aggregated, SEMANTIC_CHANNELS[-1])] if hints else [])
        self.apply(_initialise)
        for head in (self.head, *self.boosters):
            nn.init.normal_(head[-1].weight, std=0.01)  # all classes start about even

    def forward(self, image):
        *stages, context = self.semantic(image)
        aggregated = self.aggregate(self.detail(image), context)
        logits = self.head(aggregated)
        if self.training and len(self.boosters):
            return (logits, [head(stage) for head, stage in zip(self.boosters, stages)],
                    [head(features) for head, features in zip(self.hints, (aggregated, context))])
        return logits


class TwoScales(BiSeNetV2):
    """The network at inference with a second look, a quarter of its work, at the image at half its size, for people who are so near
    that they fill the view: there they are as large as those it has learnt. Not part of the paper; networks on several scales are
    (Chen et al., "Attention to Scale", CVPR 2016). H and W even multiples of 16."""

    def forward(self, image):
        return with_large_people(super().forward(image), super().forward(F.avg_pool2d(image, 2)))


def with_large_people(logits, half):
    """Makes a place a person where the image at half its size shows the inside of one: where the person's logit is above all others
    within EDGE_CELLS too. Edges and small people stay those of the whole image, for a cell of the half one is twice as wide and knows
    the place of an edge half as well.

    @param logits  N x classes x H x W  @param half  N x classes x about H/2 x W/2  @return logits"""
    margin = resize(half[:, PERSON:PERSON + 1] - _largest_other(half), logits.shape[2:])
    inside = -F.max_pool2d(-margin, 2 * EDGE_CELLS + 1, stride=1, padding=EDGE_CELLS)  # the least of the neighbourhood
    person = torch.maximum(logits[:, PERSON:PERSON + 1], _largest_other(logits) + inside)
    return torch.cat((logits[:, :PERSON], person, logits[:, PERSON + 1:]), dim=1)


def _largest_other(logits):
    """@return N x 1 x H x W, the largest logit but the person's"""
    return torch.cat((logits[:, :PERSON], logits[:, PERSON + 1:]), dim=1).amax(dim=1, keepdim=True)


def _initialise(module):
    if isinstance(module, nn.Conv2d):
        nn.init.kaiming_normal_(module.weight, mode='fan_out', nonlinearity='relu')
        if module.bias is not None:
            nn.init.zeros_(module.bias)


def inference_parameters(model):
    """Weights that remain in the exported network: all but the heads that only training has."""
    return sum(p.numel() for name, p in model.named_parameters() if not name.startswith(TRAINING_HEADS))
