"""Reads an LCM log of the daemon's recorder."""

import struct

HEAD = struct.Struct(">IQQII")  # per event: sync word, number, time in us, sizes of channel and data


def messages(path):
    """(channel, data) of each event; data begin with the type's fingerprint of 8 bytes."""
    found = []
    with open(path, "rb") as log:
        while len(head := log.read(HEAD.size)) == HEAD.size:
            _, _, _, channel_size, data_size = HEAD.unpack(head)
            channel, data = log.read(channel_size), log.read(data_size)
            found.append((channel.decode(), data))
    return found
