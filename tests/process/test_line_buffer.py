"""The sending buffers of connections: on loopback, they are left alone."""

import socket

from lcmtools.bus.line_buffer import Addresses, LineBuffer, LineBuffers


def _size(connection):
    return connection.getsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF)


def test_connections_within_a_computer_are_left_alone():
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname()) as connection,
    ):
        before = _size(connection)
        LineBuffer(connection).adjust(connection, 1.0)
        buffers = LineBuffers()
        buffers.follow([Addresses.of(connection.fileno())])
        buffers.adjust(1.0)
        assert _size(connection) == before


def test_a_connection_that_is_broken_is_no_error():
    with socket.socket() as connection:
        LineBuffer(connection).adjust(connection, 1.0)
