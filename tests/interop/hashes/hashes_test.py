"""The RIHS01 hash of each of our types, computed independently from its .msg or .srv by PyPI's
rosbags.

usage: hashes_test.py HEADERS; the folder with messages.hpp and services.hpp, which contain the
       announced hashes.
"""

import pathlib
import re
import sys

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

HEADERS, IDL = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).resolve().parents[3] / "idl"


def words_of(file):
    """rosbags has a separate id for `char`. ROS treats it as uint8: its published hash of
    ServiceEventInfo, which has one, confirms it (qos_test).
    """
    return re.sub(r"^char\b", "uint8", file.read_text(), flags=re.MULTILINE)


def announced():
    """{"pkg/msg/Name": hash}, of services too."""
    text = (HEADERS / "messages.hpp").read_text() + (HEADERS / "services.hpp").read_text()
    return dict(re.findall(r'ros_name = "([\w/]+)";\n(?:.*dds_name.*\n)?.* hash = "(\w+)";', text))


def renamed(tree, names):
    """A parsed type, with the names of services in place of those of messages, the only ones
    that rosbags supports."""
    if isinstance(tree, (tuple, list)):
        return type(tree)(renamed(part, names) for part in tree)
    return names.get(tree, tree) if isinstance(tree, str) else tree


def service_types(package, name, text):
    """ROS's description of a service: its request, its response, the event of both, and all three
    together.
    """
    request, response = re.split(r"^---$", text, flags=re.MULTILINE)
    parts = {
        f"{name}_Request": request,
        f"{name}_Response": response,
        f"{name}_Event": (
            f"service_msgs/ServiceEventInfo info\n{package}/{name}_Request[<=1]"
            f" request\n{package}/{name}_Response[<=1] response\n"
        ),
        name: (
            f"{package}/{name}_Request request_message\n{package}/{name}_Response"
            f" response_message\n{package}/{name}_Event event_message\n"
        ),
    }
    names = {f"{package}/msg/{part}": f"{package}/srv/{part}" for part in parts}
    return {
        names[key]: renamed(tree, names)
        for part, words in parts.items()
        for key, tree in get_types_from_msg(words, f"{package}/msg/{part}").items()
    }


def main():
    store, types, names = get_typestore(Stores.EMPTY), {}, []
    for folder, package in [
        (IDL, "voxtouch_msgs"),
        *((one, one.name) for one in (IDL / "ros").iterdir()),
    ]:
        for file in sorted(folder.glob("msg/*.msg")):
            types |= get_types_from_msg(words_of(file), f"{package}/msg/{file.stem}")
            names.append(f"{package}/msg/{file.stem}")
        for file in sorted(folder.glob("srv/*.srv")):
            types |= service_types(package, file.stem, words_of(file))
            names.append(f"{package}/srv/{file.stem}")
    store.register(types)
    ours = announced()
    wrong = [
        f"{name}: {ours.get(name)} is announced, {store.hash_rihs01(name)} it should be"
        for name in names
        if store.hash_rihs01(name) != ours.get(name)
    ]
    if wrong or set(ours) != set(names):
        sys.exit(
            "\n".join([*wrong, f"only announced or only a file: {sorted(set(ours) ^ set(names))}"])
        )
    print(
        f"{len(names)} types have the hashes that rosbags computes,"
        f" {sum('/srv/' in name for name in names)} of them services"
    )


if __name__ == "__main__":
    main()
