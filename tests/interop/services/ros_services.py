"""A client of ROS 2 services in rmw_cyclonedds' wire form, with types defined here, independent of
voxtouch.

A request and its reply each follow 16 bytes of the same CDR: the client's id, and the request's
number.
"""

import time
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types
from cyclonedds.idl import annotations as annotate
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

NOT_SET, BOOL, INTEGER, DOUBLE, STRING, DOUBLE_ARRAY = 0, 1, 2, 3, 4, 8


@dataclass
@annotate.final
@annotate.cdrv0
class ParameterValue(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: types.uint8 = NOT_SET
    bool_value: bool = False
    integer_value: types.int64 = 0
    double_value: types.float64 = 0.0
    string_value: str = ""
    byte_array_value: types.sequence[types.byte] = field(default_factory=list)
    bool_array_value: types.sequence[bool] = field(default_factory=list)
    integer_array_value: types.sequence[types.int64] = field(default_factory=list)
    double_array_value: types.sequence[types.float64] = field(default_factory=list)
    string_array_value: types.sequence[str] = field(default_factory=list)


@dataclass
@annotate.final
@annotate.cdrv0
class Parameter(IdlStruct, typename="rcl_interfaces::msg::dds_::Parameter_"):
    name: str = ""
    value: ParameterValue = field(default_factory=ParameterValue)


@dataclass
@annotate.final
@annotate.cdrv0
class FloatingPointRange(IdlStruct, typename="rcl_interfaces::msg::dds_::FloatingPointRange_"):
    from_value: types.float64 = 0.0
    to_value: types.float64 = 0.0
    step: types.float64 = 0.0


@dataclass
@annotate.final
@annotate.cdrv0
class IntegerRange(IdlStruct, typename="rcl_interfaces::msg::dds_::IntegerRange_"):
    from_value: types.int64 = 0
    to_value: types.int64 = 0
    step: types.uint64 = 0


@dataclass
@annotate.final
@annotate.cdrv0
class ParameterDescriptor(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterDescriptor_"):
    name: str = ""
    type: types.uint8 = 0
    description: str = ""
    additional_constraints: str = ""
    read_only: bool = False
    dynamic_typing: bool = False
    floating_point_range: types.sequence[FloatingPointRange, 1] = field(default_factory=list)
    integer_range: types.sequence[IntegerRange, 1] = field(default_factory=list)


@dataclass
@annotate.final
@annotate.cdrv0
class SetParametersResult(IdlStruct, typename="rcl_interfaces::msg::dds_::SetParametersResult_"):
    successful: bool = False
    reason: str = ""


@dataclass
@annotate.final
@annotate.cdrv0
class ListParametersResult(IdlStruct, typename="rcl_interfaces::msg::dds_::ListParametersResult_"):
    names: types.sequence[str] = field(default_factory=list)
    prefixes: types.sequence[str] = field(default_factory=list)


@dataclass
@annotate.final
@annotate.cdrv0
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: types.int32 = 0
    nanosec: types.uint32 = 0


@dataclass
@annotate.final
@annotate.cdrv0
class ParameterEvent(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterEvent_"):
    stamp: Time = field(default_factory=Time)
    node: str = ""
    new_parameters: types.sequence[Parameter] = field(default_factory=list)
    changed_parameters: types.sequence[Parameter] = field(default_factory=list)
    deleted_parameters: types.sequence[Parameter] = field(default_factory=list)


@dataclass
@annotate.final
@annotate.cdrv0
class Log(IdlStruct, typename="rcl_interfaces::msg::dds_::Log_"):
    stamp: Time = field(default_factory=Time)
    level: types.uint8 = 0
    name: str = ""
    msg: str = ""
    file: str = ""
    function: str = ""
    line: types.uint32 = 0


@dataclass
@annotate.final
@annotate.cdrv0
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
@annotate.final
@annotate.cdrv0
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header = field(default_factory=Header)
    name: types.sequence[str] = field(default_factory=list)
    position: types.sequence[types.float64] = field(default_factory=list)
    velocity: types.sequence[types.float64] = field(default_factory=list)
    effort: types.sequence[types.float64] = field(default_factory=list)


@dataclass
@annotate.final
@annotate.cdrv0
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str = ""


@dataclass
@annotate.final
@annotate.cdrv0
class ListParameters_Request(
    IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Request_"
):
    client: types.uint64
    number: types.int64
    prefixes: types.sequence[str] = field(default_factory=list)
    depth: types.uint64 = 0


@dataclass
@annotate.final
@annotate.cdrv0
class ListParameters_Response(
    IdlStruct, typename="rcl_interfaces::srv::dds_::ListParameters_Response_"
):
    client: types.uint64
    number: types.int64
    result: ListParametersResult


@dataclass
@annotate.final
@annotate.cdrv0
class GetParameters_Request(
    IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Request_"
):
    client: types.uint64
    number: types.int64
    names: types.sequence[str]


@dataclass
@annotate.final
@annotate.cdrv0
class GetParameters_Response(
    IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Response_"
):
    client: types.uint64
    number: types.int64
    values: types.sequence[ParameterValue]


@dataclass
@annotate.final
@annotate.cdrv0
class GetParameterTypes_Request(
    IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameterTypes_Request_"
):
    client: types.uint64
    number: types.int64
    names: types.sequence[str]


@dataclass
@annotate.final
@annotate.cdrv0
class GetParameterTypes_Response(
    IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameterTypes_Response_"
):
    client: types.uint64
    number: types.int64
    types: types.sequence[types.uint8]


@dataclass
@annotate.final
@annotate.cdrv0
class DescribeParameters_Request(
    IdlStruct, typename="rcl_interfaces::srv::dds_::DescribeParameters_Request_"
):
    client: types.uint64
    number: types.int64
    names: types.sequence[str]


@dataclass
@annotate.final
@annotate.cdrv0
class DescribeParameters_Response(
    IdlStruct, typename="rcl_interfaces::srv::dds_::DescribeParameters_Response_"
):
    client: types.uint64
    number: types.int64
    descriptors: types.sequence[ParameterDescriptor]


@dataclass
@annotate.final
@annotate.cdrv0
class SetParameters_Request(
    IdlStruct, typename="rcl_interfaces::srv::dds_::SetParameters_Request_"
):
    client: types.uint64
    number: types.int64
    parameters: types.sequence[Parameter]


@dataclass
@annotate.final
@annotate.cdrv0
class SetParameters_Response(
    IdlStruct, typename="rcl_interfaces::srv::dds_::SetParameters_Response_"
):
    client: types.uint64
    number: types.int64
    results: types.sequence[SetParametersResult]


@dataclass
@annotate.final
@annotate.cdrv0
class SetParametersAtomically_Request(
    IdlStruct, typename="rcl_interfaces::srv::dds_::SetParametersAtomically_Request_"
):
    client: types.uint64
    number: types.int64
    parameters: types.sequence[Parameter]


@dataclass
@annotate.final
@annotate.cdrv0
class SetParametersAtomically_Response(
    IdlStruct, typename="rcl_interfaces::srv::dds_::SetParametersAtomically_Response_"
):
    client: types.uint64
    number: types.int64
    result: SetParametersResult


@dataclass
@annotate.final
@annotate.cdrv0
class ChangeEffect_Request(IdlStruct, typename="voxtouch_msgs::srv::dds_::ChangeEffect_Request_"):
    client: types.uint64
    number: types.int64
    session_id: types.uint64 = 0
    from_sample: types.uint64 = 0
    action: types.uint32 = 0
    effect: str = ""
    parameter: str = ""
    value: types.array[types.float64, 3] = field(default_factory=lambda: [0.0] * 3)
    voxel_size_m: types.float64 = 0.0
    model: str = ""


@dataclass
@annotate.final
@annotate.cdrv0
class ChangeEffect_Response(IdlStruct, typename="voxtouch_msgs::srv::dds_::ChangeEffect_Response_"):
    client: types.uint64
    number: types.int64
    done: bool
    from_sample: types.uint64
    sentence: str


SERVICES = {
    "list_parameters": (ListParameters_Request, ListParameters_Response),
    "get_parameters": (GetParameters_Request, GetParameters_Response),
    "get_parameter_types": (GetParameterTypes_Request, GetParameterTypes_Response),
    "describe_parameters": (DescribeParameters_Request, DescribeParameters_Response),
    "set_parameters": (SetParameters_Request, SetParameters_Response),
    "set_parameters_atomically": (
        SetParametersAtomically_Request,
        SetParametersAtomically_Response,
    ),
    "change_effect": (ChangeEffect_Request, ChangeEffect_Response),
}
QOS = (
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(10),
)


class Client:
    """As in rmw_cyclonedds: its number is its writer's instance handle, and both endpoints announce
    the same client.
    """

    count = 0

    def __init__(self, participant, node, service, receives=True):
        request, response = SERVICES[service]
        Client.count += 1
        qos = Qos(*QOS, Policy.Userdata(f"clientid={participant.guid}.{Client.count};".encode()))
        self.kind, self.name, self.number = request, f"{node}/{service}", 0
        self.reader = (
            DataReader(
                participant, Topic(participant, f"rr{node}/{service}Reply", response), qos=qos
            )
            if receives
            else None
        )
        self.writer = DataWriter(
            participant, Topic(participant, f"rq{node}/{service}Request", request), qos=qos
        )
        self.guid = self.writer.get_instance_handle() & (1 << 64) - 1

    def ready(self):
        return self.writer.get_matched_subscriptions() and self.reader.get_matched_publications()

    def send(self, **fields):
        self.number += 1
        self.writer.write(self.kind(client=self.guid, number=self.number, **fields))

    def call(self, patience_s=20.0, again_s=None, **fields):
        """The reply; an error without one. `again_s`: repeats the request after each such time,
        if that is permitted; any reply counts."""
        begin = time.monotonic()
        self.send(**fields)
        first, asked = self.number, begin
        while time.monotonic() < begin + patience_s:
            for reply in self.reader.take(N=10):
                if (
                    reply.sample_info.valid_data
                    and reply.client == self.guid
                    and first <= reply.number <= self.number
                ):
                    return reply
            if again_s and time.monotonic() > asked + again_s:
                self.send(**fields)
                asked = time.monotonic()
            time.sleep(0.0002)
        raise AssertionError(f"{self.name} does not answer")


def parameter(name, value):
    kinds = {
        bool: ("bool_value", BOOL),
        int: ("integer_value", INTEGER),
        float: ("double_value", DOUBLE),
        str: ("string_value", STRING),
        list: ("double_array_value", DOUBLE_ARRAY),
    }
    if value is None:
        return Parameter(name=name)
    key, kind = kinds[type(value)]
    return Parameter(name=name, value=ParameterValue(type=kind, **{key: value}))


def plain(value):
    """A ParameterValue as a value of Python."""
    return {
        NOT_SET: None,
        BOOL: value.bool_value,
        INTEGER: value.integer_value,
        DOUBLE: value.double_value,
        STRING: value.string_value,
        DOUBLE_ARRAY: list(value.double_array_value),
    }[value.type]
