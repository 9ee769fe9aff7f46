# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rewrites an exported network into one that computes the same and is faster once quantised (quantize.py)."""
import numpy as np

from network_file import weights_of_small

REGROUPING = 'Transpose', 'Reshape'


def grey(mean):
    """@param mean  of each channel, 0 to 255  @return the pixel value that is zero to the quantised network"""
    return round(float(np.mean(mean)))


def prepare(network, out, mean, std):
    """Writes a float network as it is best quantised: normalisations are part of the convolutions. The image is 1 x H x W x 3, in pixel values less grey(mean), and the first convolutions read several pixels of a row at once.

    @param mean, std  of each channel, 0 to 255: the network's image is (pixel - mean) / std, 1 x 3 x H x W"""
    import onnx
    from onnx import numpy_helper
    from onnxruntime.quantization.shape_inference import quant_pre_process
    model = onnx.load(network)
    plain = weights_of_small(model.graph)  # not seen as weights, else, and no normalisation enters them
    if plain:
        print(f"'{network}' has weights of 8 bits (export.py --small), which are rounded again now; an export without it is nearer")
    nodes = [node for node in model.graph.node if node.output[0] not in plain]
    del model.graph.node[:]
    model.graph.node.extend(nodes)
    model.graph.initializer.extend(numpy_helper.from_array(values, name) for name, values in plain.items())
    quant_pre_process(model, out)
    model = onnx.load(out)
    _give_each_its_own(model.graph)
    _take_bytes(model.graph, np.array(mean), np.array(std))
    _drop_unused(model.graph)
    _share_equal(model.graph)
    onnx.checker.check_model(model)
    onnx.save(model, out)


def _give_each_its_own(graph):
    """Copies weights that several convolutions use, so that each can be changed for itself."""
    weights, used = {w.name: w for w in graph.initializer}, set()
    for node in graph.node:
        for i, name in enumerate(node.input) if node.op_type == 'Conv' else ():
            if name in used:
                graph.initializer.add().CopyFrom(weights[name])
                node.input[i] = graph.initializer[-1].name = f'{name}_of_{node.name}'
            elif name in weights:
                used.add(name)


def _drop_unused(graph):
    """Takes the nodes away whose output nothing reads; the runtime would compute it."""
    used = {output.name for output in graph.output}
    for node in reversed(list(graph.node)):
        if used.isdisjoint(node.output):
            graph.node.remove(node)
        else:
            used.update(node.input)


def _share_equal(graph):
    """Stores equal weights of several convolutions once; a bias is quantised by what comes in, and stays for itself."""
    first, same = {}, {}
    for weights in graph.initializer:
        content = (tuple(weights.dims), weights.raw_data)
        if len(weights.dims) == 4 and first.setdefault(content, weights.name) != weights.name:
            same[weights.name] = first[content]
    for node in graph.node:
        for i, name in enumerate(node.input):
            node.input[i] = same.get(name, name)
    kept = [weights for weights in graph.initializer if weights.name not in same]
    del graph.initializer[:]
    graph.initializer.extend(kept)


def _take_bytes(graph, mean, std):
    """Normalisation becomes part of the convolutions that read the image, or its average over 2x2 of a network for two scales. What
    they pad the image with is grey then, with export.py's a sixth of a standard deviation off the mean at most."""
    from onnx import helper, numpy_helper
    weights, image = {w.name: w for w in graph.initializer}, graph.input[0]
    pools = [node for node in graph.node if node.op_type == 'AveragePool' and node.input[0] == image.name]
    convolutions = [node for node in graph.node
                    if node.op_type == 'Conv' and node.input[0] in [image.name] + [pool.output[0] for pool in pools]]
    readers = [node for node in graph.node if image.name in node.input]
    if not convolutions or not all(node in pools + convolutions for node in readers) or any(len(n.input) != 3 for n in convolutions):
        raise SystemExit('this network does not begin with convolutions of its image; export.py writes those that do')
    gain, offset = 1 / std, (grey(mean) - mean) / std
    for node in convolutions:
        values, bias = (numpy_helper.to_array(weights[name]) for name in node.input[1:])
        for name, changed in zip(node.input[1:], (values * gain[:, None, None], bias + values.sum((2, 3)) @ offset)):
            weights[name].CopyFrom(numpy_helper.from_array(changed.astype(np.float32), name))
    planes = helper.make_node('Transpose', [image.name], [image.name + '_planes'], image.name + '_planes', perm=[0, 3, 1, 2])
    for node in graph.node:
        node.input[:] = [planes.output[0] if name == image.name else name for name in node.input]
    graph.node.insert(0, planes)
    dims = image.type.tensor_type.shape.dim
    for dim, value in zip(dims, [dim.dim_value for dim in (dims[0], dims[2], dims[3], dims[1])]):
        dim.dim_value = value
    for pool in pools:
        quarters = np.eye(3, dtype=np.float32)[:, :, None, None].repeat(2, 2).repeat(2, 3) / 4
        graph.initializer.append(numpy_helper.from_array(quarters, pool.name + '_quarters'))
        pool.op_type = 'Conv'
        pool.input.append(pool.name + '_quarters')
        del pool.attribute[:]
        pool.attribute.extend(helper.make_node('Conv', [], [], kernel_shape=[2, 2], strides=[2, 2], pads=[0] * 4, group=1).attribute)
        _in_blocks(graph, pool, 16)
    for node in convolutions:
        _in_blocks(graph, node, 4)


def _in_blocks(graph, node, pixels):
    """Turns a convolution of few channels into one of `pixels` times as many, at blocks of a row. It multiplies zeros too, but ONNX
    Runtime spends the time of such convolutions on gathering, with a copy for each pixel of the kernel: from 704x544x3 to
    352x272x24 it needs 2.9 ms in blocks of 2 pixels, 1.1 of 4, 1.3 of 8."""
    from onnx import helper, numpy_helper
    stored = next(w for w in graph.initializer if w.name == node.input[1])
    values = numpy_helper.to_array(stored)
    outputs, channels, height, width = values.shape
    has = {a.name: a for a in node.attribute}
    stride, left = has['strides'].ints[1], has['pads'].ints[1]
    count = pixels // stride  # of outputs in a block
    before, after = -(-left // pixels), ((count - 1) * stride - left + width - 1) // pixels  # further blocks that they need
    blocks = np.zeros((count, outputs, before + 1 + after, pixels, channels, height), values.dtype)
    for k in range(count):
        for u in range(width):
            block, pixel = divmod(k * stride - left + u, pixels)
            blocks[k, :, before + block, pixel] = values[..., u]
    blocks = blocks.transpose(0, 1, 3, 4, 5, 2).reshape(count * outputs, pixels * channels, height, -1)
    stored.CopyFrom(numpy_helper.from_array(blocks, stored.name))
    if len(node.input) > 2:
        bias = next(w for w in graph.initializer if w.name == node.input[2])
        bias.CopyFrom(numpy_helper.from_array(np.tile(numpy_helper.to_array(bias), count), bias.name))
    has['kernel_shape'].ints[1], has['strides'].ints[1] = before + 1 + after, 1
    has['pads'].ints[1], has['pads'].ints[3] = before, after

    def regroup(source, result, channels):
        """@return nodes that make of a tensor's rows such of so many channels"""
        names = [result + part for part in ('_shape', '_rows', '_regrouped')]
        graph.initializer.append(numpy_helper.from_array(np.array([0, 0, -1, channels]), names[0]))
        rows = [n.input[0] for n in graph.node if n.output[0] == source and n.op_type == 'Transpose']  # back, or there already
        return ([] if rows else [helper.make_node('Transpose', [source], names[1:2], names[1], perm=[0, 2, 3, 1])]) + [
                helper.make_node('Reshape', [rows[0] if rows else names[1], names[0]], names[2:3], names[2]),
                helper.make_node('Transpose', names[2:3], [result], result, perm=[0, 3, 1, 2])]

    place = list(graph.node).index(node)
    for k, added in enumerate(regroup(node.input[0], node.name + '_blocks', pixels * channels)):
        graph.node.insert(place + k, added)
    node.input[0] = node.name + '_blocks'
    users = [user for user in graph.node if node.output[0] in user.input]
    last = users[0] if users[0].op_type in ('Relu', 'Clip') else node  # which becomes part of the convolution
    result = last.output[0]
    last.output[0] = node.name + '_of_blocks'
    if last is not node:
        node.output[0] = last.input[0] = node.name + '_sums'
    for k, added in enumerate(regroup(last.output[0], result, outputs)):
        graph.node.insert(list(graph.node).index(last) + 1 + k, added)


def pixels(graph):
    """@return names of the tensors that are the image, whole or regrouped"""
    names = {graph.input[0].name}
    for node in graph.node:
        if node.op_type in REGROUPING and node.input[0] in names:
            names.add(node.output[0])
    return names
