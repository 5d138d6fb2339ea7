//! The actor as an ONNX graph: observations in, head outputs and deterministic actions out.
//!
//! The graph repeats the network's forward pass operator by operator. Rows are free; the numbers
//! of hotspots and neighbours are those of the shape it is written for.

mod graph;
mod set;

use super::Actor;
use crate::environment::Shape;
use crate::network::Architecture;
use crate::ppo::normalise::CLIP;
use graph::{Graph, Value};
use jcas_policy::head::{Head, MOTIONS};

/// Name of the input, rows × observation fields.
pub const INPUT: &str = "observations";
/// Name of the raw head outputs.
pub const OUTPUTS: &str = "distribution";
/// Name of the deterministic actions, rows × 2.
pub const ACTIONS: &str = "actions";

/// The bytes of an ONNX model of the actor for missions of this shape.
pub fn encode(actor: &Actor, shape: &Shape) -> Vec<u8> {
    let mut graph = Graph::new("jcas-policy");
    let fields = shape.observation_len;
    let mut hidden = graph.input(INPUT, fields);
    if !actor.inputs.offset.is_empty() {
        let offset = graph.constant(&[1, fields], &actor.inputs.offset);
        let scale = graph.constant(&[1, fields], &actor.inputs.scale);
        let low = graph.constant(&[], &[-CLIP]);
        let high = graph.constant(&[], &[CLIP]);
        hidden = graph.binary("Sub", &hidden, &offset);
        hidden = graph.binary("Div", &hidden, &scale);
        hidden = graph.op("Clip", &[&hidden, &low, &high], &[]);
    }
    let weights: Vec<Value> = actor
        .network
        .blocks
        .iter()
        .map(|block| {
            let values = &actor.parameters[block.offset..block.offset + block.len()];
            graph.constant(
                &[block.rows as i64, block.columns as i64].map(|x| x as usize),
                values,
            )
        })
        .collect();
    let outputs = match &actor.network.architecture {
        Architecture::SetActor { fleet_size, .. } => {
            set::actor(&mut graph, &weights, hidden, *fleet_size, shape)
        }
        _ => mlp(&mut graph, &weights, hidden),
    };
    let actions = actions(&mut graph, actor, &outputs);
    graph.output(&outputs, OUTPUTS, actor.head.outputs());
    graph.output(&actions, ACTIONS, 2);
    graph.encode()
}

fn mlp(graph: &mut Graph, weights: &[Value], input: Value) -> Value {
    let last = weights.len() / 2 - 1;
    let mut hidden = input;
    for (layer, pair) in weights.chunks_exact(2).enumerate() {
        hidden = graph.linear(&hidden, &pair[0], &pair[1]);
        if layer < last {
            hidden = graph.op("Relu", &[&hidden], &[]);
        }
    }
    hidden
}

/// The deterministic action pairs, as `Head::deterministic` and `Head::action` give them.
fn actions(graph: &mut Graph, actor: &Actor, outputs: &Value) -> Value {
    let one = graph.constant(&[], &[1.0]);
    let minus_one = graph.constant(&[], &[-1.0]);
    let (direction, pilot) = match actor.head {
        Head::Gaussian => {
            let means = graph.columns(outputs, 0, 2);
            let clipped = graph.op("Clip", &[&means, &minus_one, &one], &[]);
            (graph.columns(&clipped, 0, 1), graph.columns(&clipped, 1, 2))
        }
        Head::Hybrid => {
            let logits = graph.columns(outputs, 0, MOTIONS);
            let motion = graph.arg_max(&logits);
            let width = graph.constant(&[], &[0.4]);
            let first = graph.constant(&[], &[-0.8]);
            let direction = graph.binary("Mul", &motion, &width);
            let direction = graph.binary("Add", &direction, &first);
            let raw = graph.columns(outputs, MOTIONS, MOTIONS + 2);
            let ab = graph.op("Softplus", &[&raw], &[]);
            let ab = graph.binary("Add", &ab, &one);
            let alpha = graph.columns(&ab, 0, 1);
            let beta = graph.columns(&ab, 1, 2);
            let sum = graph.binary("Add", &alpha, &beta);
            let mean = graph.binary("Div", &alpha, &sum);
            let two = graph.constant(&[], &[2.0]);
            let pilot = graph.binary("Mul", &mean, &two);
            (direction, graph.binary("Sub", &pilot, &one))
        }
    };
    let pilot = match actor.constant_pilot {
        None => pilot,
        Some(held) => {
            let zero = graph.constant(&[], &[0.0]);
            let held = graph.constant(&[], &[held]);
            let nothing = graph.binary("Mul", &pilot, &zero);
            graph.binary("Add", &nothing, &held)
        }
    };
    graph.concat(&[&direction, &pilot], 1)
}
