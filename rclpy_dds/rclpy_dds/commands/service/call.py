"""Call a service."""

from __future__ import annotations

import argparse
import sys
import time

from rclpy_dds.commands.common import command_node, spin
from rclpy_dds.commands.values import fill, load_class, load_values


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    parser.add_argument("service_name", help="Name of the ROS service to call to (e.g. '/add_two_ints')")
    parser.add_argument("service_type", help="Type of the ROS service (e.g. 'std_srvs/srv/Empty')")
    parser.add_argument(
        "values", nargs="?", default="{}", help="Values to fill the service request with in YAML format"
    )
    parser.add_argument("--stdin", action="store_true", help="Read values from standard input")
    parser.add_argument("-r", "--rate", metavar="N", type=float, help="Repeat the call at a specific rate in Hz")
    parser.add_argument("--timeout", metavar="N", type=float, help="Give up after N seconds (default: wait for ever)")


def main(args: argparse.Namespace) -> str | None:
    """Call the service and print request and reply."""
    if args.rate is not None and args.rate <= 0:
        return "rate must be greater than zero"
    srv_type = load_class(args.service_type, "srv")
    request = fill(srv_type.Request(), load_values(sys.stdin.read() if args.stdin else args.values))
    with command_node() as node:
        client = node.create_client(srv_type, args.service_name)
        if not client.service_is_ready():
            print("waiting for service to become available...", flush=True)
            if not client.wait_for_service(args.timeout):
                return f"service {args.service_name} is not available after {args.timeout} s" if args.timeout else None
        while True:
            print(f"requester: making request: {request!r}\n", flush=True)
            future = client.call_async(request)
            spin(node, future, args.timeout)
            if not future.done():
                return f"service {args.service_name} did not answer within {args.timeout} s"
            print(f"response:\n{future.result()!r}\n", flush=True)
            if args.rate is None:
                return None
            time.sleep(1.0 / args.rate)
