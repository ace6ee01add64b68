//! A process of ros2-client (RustDDS) with its default settings: what it gets of the ring, and how soon a change of an effect is answered. usage: voxtouch_ros2_client DOMAIN SECONDS [CHANGES]. Prints one JSON object.
use std::thread::sleep;
use std::time::{Duration, Instant};

use ros2_client::qos::{Durability, History, QosProfile};
use ros2_client::{
    Context, ContextOptions, Message, MessageTypeName, Name, Node, NodeName, NodeOptions, ServiceMapping, ServiceTypeName, Subscription,
    DEFAULT_PUBLISHER_QOS, DEFAULT_SUBSCRIPTION_QOS,
};
use serde::{de::DeserializeOwned, Deserialize, Serialize};

// Messages as far as they are looked at: a reader of CDR may stop before the end.
#[derive(Deserialize)]
struct Sample {
    _session_id: u64,
    sequence_number: u64,
}
#[derive(Deserialize)]
struct Header {
    _stamp: (i32, u32),
    frame_id: String,
}
#[derive(Deserialize)]
struct Stamped {
    header: Header,
}
#[derive(Deserialize)]
struct Transforms {
    transforms: Vec<Transform>,
}
#[derive(Deserialize)]
struct Transform {
    header: Header,
    child_frame_id: String,
    _vector_and_quaternion: [f64; 7],
}
#[derive(Deserialize)]
struct Anything {}

#[derive(Clone, Serialize, Deserialize)]
struct ChangeRequest {
    session_id: u64,
    from_sample: u64,
    action: u32,
    effect: String,
    parameter: String,
    value: [f64; 3],
    voxel_size_m: f64,
    model: String,
}
impl Message for ChangeRequest {}
#[derive(Serialize, Deserialize)]
struct ChangeReply {
    done: bool,
    from_sample: u64,
    sentence: String,
}
impl Message for ChangeReply {}

fn name(text: &str) -> Name {
    Name::parse(text).unwrap()
}

fn subscribe<M: DeserializeOwned + 'static>(node: &mut Node, topic: &str, package: &str, kind: &str, qos: QosProfile) -> Subscription<M> {
    let topic = node.create_topic(&name(topic), MessageTypeName::new(package, kind), &qos).unwrap();
    node.create_subscription::<M>(&topic, None).unwrap()
}

/// One of the loop's topics: what came of the samples, which the device has numbered.
struct Stream {
    topic: &'static str,
    subscription: Subscription<Sample>,
    received: u64,
    first: u64,
    last: u64,
    first_s: f64,
}

impl Stream {
    fn new(node: &mut Node, topic: &'static str, kind: &str) -> Stream {
        let qos = DEFAULT_SUBSCRIPTION_QOS.history(History::KeepLast { depth: 1000 });
        Stream { topic, subscription: subscribe(node, topic, "voxtouch_msgs", kind, qos), received: 0, first: 0, last: 0, first_s: -1.0 }
    }
    fn look(&mut self, now_s: f64) {
        while let Ok(Some((sample, _))) = self.subscription.take() {
            if self.received == 0 {
                (self.first, self.first_s) = (sample.sequence_number, now_s);
            }
            self.received += 1;
            self.last = sample.sequence_number;
        }
    }
    fn json(&self) -> String {
        let lost = if self.received > 0 { self.last + 1 - self.first - self.received } else { 0 };
        format!("\"rt{}\": [{}, {}]", self.topic, self.received, lost)
    }
}

/// A topic of a standard type; `poll` counts what makes sense.
struct Standard {
    topic: &'static str,
    look: Box<dyn Fn() -> usize>,
    received: usize,
}

impl Standard {
    fn new<M: DeserializeOwned + 'static>(
        node: &mut Node, topic: &'static str, package: &str, kind: &str, qos: QosProfile, makes_sense: impl Fn(&M) -> bool + 'static,
    ) -> Standard {
        let subscription = subscribe::<M>(node, topic, package, kind, qos);
        let look = move || {
            let mut count = 0;
            while let Ok(Some((message, _))) = subscription.take() {
                count += usize::from(makes_sense(&message));
            }
            count
        };
        Standard { topic, look: Box::new(look), received: 0 }
    }
    fn look(&mut self) {
        self.received += (self.look)();
    }
}

/// Milliseconds until each of so many changes was answered as made, in rmw_cyclonedds' wire form. A shorter list: somebody did not answer.
fn ask_for_changes(node: &mut Node, count: usize) -> Vec<f64> {
    let qos = DEFAULT_PUBLISHER_QOS.history(History::KeepLast { depth: 10 });
    let client = node
        .create_client::<ChangeRequest, ChangeReply>(
            ServiceMapping::Cyclone,
            &name("/haptic/rendering/change_effect"),
            &ServiceTypeName::new("voxtouch_msgs", "ChangeEffect"),
            qos.clone(),
            qos,
        )
        .unwrap();
    let ask = |gain: f64, patience: Duration| -> Option<f64> {
        let begin = Instant::now();
        let request = ChangeRequest {
            session_id: 0, from_sample: 0, action: 2, effect: "friction".into(), parameter: String::new(), value: [gain, 0.0, 0.0], voxel_size_m: 0.0,
            model: String::new(),
        };
        let id = client.send_request(request).ok()?;
        while begin.elapsed() < patience {
            match client.receive_response() {
                Ok(Some((answered, reply))) if answered == id => return reply.done.then(|| 1e3 * begin.elapsed().as_secs_f64()),
                Ok(Some(_)) => {}
                _ => sleep(Duration::from_micros(200)),
            }
        }
        None
    };
    // Whether the server is known only a running Spinner tells: what is asked before gets no answer.
    if !(0..20).any(|_| ask(1.0, Duration::from_millis(500)).is_some()) {
        return Vec::new();
    }
    (0..count)
        .filter_map(|n| {
            sleep(Duration::from_millis(10));
            ask(if n % 2 == 0 { 0.5 } else { 1.0 }, Duration::from_secs(5))
        })
        .collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let seconds: f64 = arguments[2].parse().unwrap();
    let context = Context::with_options(ContextOptions::new().domain_id(arguments[1].parse().unwrap())).unwrap();
    let mut node = context.new_node(NodeName::new("/", "ros2_client").unwrap(), NodeOptions::new()).unwrap();
    let n = &mut node;
    let mut streams = [
        Stream::new(n, "/haptic/device/state", "DeviceState"),
        Stream::new(n, "/haptic/rendering/contact", "ContactState"),
        Stream::new(n, "/haptic/coupling/command", "ForceCommand"),
    ];
    let reliable = DEFAULT_PUBLISHER_QOS.history(History::KeepLast { depth: 10 });
    let latched = reliable.clone().durability(Durability::TransientLocal);
    let of_tool = |m: &Transforms| !m.transforms.is_empty() && m.transforms.iter().all(|t| !t.child_frame_id.is_empty() && !t.header.frame_id.is_empty());
    let in_frame = |m: &Stamped| !m.header.frame_id.is_empty();
    let mut standard = [
        Standard::new(n, "/tf", "tf2_msgs", "TFMessage", reliable.clone(), of_tool),
        Standard::new(n, "/tf_static", "tf2_msgs", "TFMessage", latched.clone(), of_tool),
        Standard::new(n, "/haptic/pose", "geometry_msgs", "PoseStamped", reliable.clone(), in_frame),
        Standard::new(n, "/haptic/wrench", "geometry_msgs", "WrenchStamped", reliable.clone(), in_frame),
        Standard::new(n, "/haptic/markers", "visualization_msgs", "MarkerArray", reliable.clone(), |_: &Anything| true),
        Standard::new(n, "/diagnostics", "diagnostic_msgs", "DiagnosticArray", reliable.clone(), |_: &Stamped| true),
        Standard::new(n, "/parameter_events", "rcl_interfaces", "ParameterEvent", reliable, |_: &Anything| true),
        Standard::new(n, "/rosout", "rcl_interfaces", "Log", latched, |_: &Anything| true),
    ];
    let begin = Instant::now();
    while begin.elapsed().as_secs_f64() < seconds {
        streams.iter_mut().for_each(|one| one.look(begin.elapsed().as_secs_f64()));
        standard.iter_mut().for_each(Standard::look);
        sleep(Duration::from_millis(5));
    }
    let answers_ms = arguments.get(3).map_or(Vec::new(), |count| ask_for_changes(&mut node, count.parse().unwrap()));
    standard.iter_mut().for_each(Standard::look);
    let join = |parts: Vec<String>| parts.join(", ");
    println!(
        "{{\"samples\": {}, \"first_s\": {}, \"streams\": {{{}}}, \"standard\": {{{}}}, \"answers_ms\": [{}]}}",
        streams[0].received,
        streams[0].first_s,
        join(streams.iter().map(Stream::json).collect()),
        join(standard.iter().map(|one| format!("\"rt{}\": {}", one.topic, one.received)).collect()),
        join(answers_ms.iter().map(|ms| format!("{ms:.3}")).collect())
    );
}
