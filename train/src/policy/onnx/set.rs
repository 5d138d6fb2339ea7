//! The set actor as a graph: the function of `network::set::actor`, from the bare observation on.
//!
//! What that module works out in plain loops, or leaves out because it cancels, is written out here.

use super::graph::{Graph, Value};
use crate::environment::Shape;
use crate::network::set::{
    CROWD, HEADS, HOTSPOT_FIELDS, HOTSPOT_WIDTH, OWN_FIRST, SLOT_FIELDS, UAV_WIDTH,
};

struct Builder<'a> {
    graph: &'a mut Graph,
    weights: std::slice::Iter<'a, Value>,
}

impl Builder<'_> {
    fn take(&mut self) -> Value {
        self.weights
            .next()
            .expect("as many weights as blocks")
            .clone()
    }

    fn linear(&mut self, x: &Value) -> Value {
        let (weight, bias) = (self.take(), self.take());
        self.graph.linear(x, &weight, &bias)
    }

    fn relu(&mut self, x: &Value) -> Value {
        self.graph.op("Relu", &[x], &[])
    }

    fn scaled(&mut self, x: &Value, factor: f32) -> Value {
        let factor = self.graph.constant(&[], &[factor]);
        self.graph.binary("Mul", x, &factor)
    }

    /// Sum over the elements of a set, rows × width.
    fn pool(&mut self, set: &Value) -> Value {
        let sum = self.graph.sum(set, 1, false);
        self.scaled(&sum, 1.0 / CROWD)
    }

    fn added_to_each(&mut self, set: &Value, row: &Value) -> Value {
        let row = self.graph.reshape(row, &[0, 1, HOTSPOT_WIDTH as i64]);
        self.graph.binary("Add", set, &row)
    }

    fn set_of(&mut self, input: &Value, first: usize, count: usize, fields: usize) -> Value {
        let columns = self.graph.columns(input, first, first + count * fields);
        self.graph
            .reshape(&columns, &[0, count as i64, fields as i64])
    }

    fn field(&mut self, set: &Value, index: usize) -> Value {
        self.graph.slice(set, 2, index, index + 1)
    }

    fn distance(&mut self, dx: &Value, dy: &Value, shape: &Shape) -> Value {
        let [x_cells, y_cells] = shape.position_cells();
        let dx = self.graph.op("Abs", &[dx], &[]);
        let dy = self.graph.op("Abs", &[dy], &[]);
        let (dx, dy) = (self.scaled(&dx, x_cells), self.scaled(&dy, y_cells));
        self.graph.binary("Add", &dx, &dy)
    }

    fn nearness(&mut self, distance: &Value, reach: f32) -> Value {
        let falling = self.scaled(distance, -1.0 / reach);
        let one = self.graph.constant(&[], &[1.0]);
        let line = self.graph.binary("Add", &falling, &one);
        self.relu(&line)
    }
}

pub(super) fn actor(
    graph: &mut Graph,
    weights: &[Value],
    input: Value,
    fleet_size: bool,
    shape: &Shape,
) -> Value {
    let mut b = Builder {
        graph,
        weights: weights.iter(),
    };
    let (n, k) = (shape.hotspots, shape.neighbour_slots);
    let hotspots = b.set_of(&input, OWN_FIRST, n, HOTSPOT_FIELDS);
    let slots_first = OWN_FIRST + HOTSPOT_FIELDS * n;
    let tail_first = slots_first + SLOT_FIELDS * k;
    let head = b.graph.columns(&input, 0, OWN_FIRST);
    let tail = b.graph.columns(&input, tail_first, shape.observation_len);
    let own = if fleet_size {
        let first = b.graph.columns(&input, 0, 1);
        let zero = b.scaled(&first, 0.0);
        let size = b.graph.constant(&[1, 1], &[shape.agents as f32 / CROWD]);
        let size = b.graph.binary("Add", &zero, &size);
        b.graph.concat(&[&head, &tail, &size], 1)
    } else {
        b.graph.concat(&[&head, &tail], 1)
    };

    let (hotspot_x, hotspot_y) = (b.field(&hotspots, 0), b.field(&hotspots, 1));
    let distance = b.distance(&hotspot_x, &hotspot_y, shape);
    let (neighbours, at, around) = if k == 0 {
        b.weights.by_ref().take(4).for_each(drop);
        let none = b.scaled(&distance, 0.0);
        let zero_row = b.graph.constant(&[1, UAV_WIDTH], &[0.0; UAV_WIDTH]);
        let first = b.graph.columns(&input, 0, 1);
        let zero = b.scaled(&first, 0.0);
        (b.graph.binary("Add", &zero, &zero_row), none.clone(), none)
    } else {
        let slots = b.set_of(&input, slots_first, k, SLOT_FIELDS);
        let present = b.field(&slots, 0);
        let embedded = b.linear(&slots);
        let embedded = b.relu(&embedded);
        let embedded = b.linear(&embedded);
        let embedded = b.relu(&embedded);
        let embedded = b.graph.binary("Mul", &embedded, &present);
        let (slot_x, slot_y) = (b.field(&slots, 1), b.field(&slots, 2));
        let (slot_x, slot_y) = (b.graph.swap(&slot_x), b.graph.swap(&slot_y));
        let dx = b.graph.binary("Sub", &hotspot_x, &slot_x);
        let dy = b.graph.binary("Sub", &hotspot_y, &slot_y);
        let apart = b.distance(&dx, &dy, shape);
        let present = b.graph.swap(&present);
        let mut count = |reach: f32| {
            let near = b.nearness(&apart, reach);
            let near = b.graph.binary("Mul", &near, &present);
            let sum = b.graph.sum(&near, 2, true);
            b.scaled(&sum, 1.0 / CROWD)
        };
        let (at, around) = (count(1.0), count(4.0));
        (b.pool(&embedded), at, around)
    };

    let [x_cells, _] = shape.position_cells();
    let far = b.scaled(&distance, 1.0 / (2.0 * x_cells));
    let (here, near) = (b.nearness(&distance, 1.0), b.nearness(&distance, 4.0));
    let features = b
        .graph
        .concat(&[&hotspots, &far, &here, &near, &at, &around], 2);
    let context = b.graph.concat(&[&own, &neighbours], 1);
    let embedded = b.linear(&features);
    let weight = b.take();
    let context = b.graph.binary("MatMul", &context, &weight);
    let embedded = b.added_to_each(&embedded, &context);
    let embedded = b.relu(&embedded);
    let embedded = b.linear(&embedded);
    let embedded = b.relu(&embedded);
    let others = b.pool(&embedded);
    let embedded = b.linear(&embedded);
    let weight = b.take();
    let others = b.graph.binary("MatMul", &others, &weight);
    let embedded = b.added_to_each(&embedded, &others);
    let embedded = b.relu(&embedded);
    let scores = b.linear(&embedded);
    let attention = b.graph.op("Softmax", &[&scores], &[("axis", 1)]);
    let attention = b.graph.swap(&attention);
    let attended = b.graph.binary("MatMul", &attention, &embedded);
    let attended = b
        .graph
        .reshape(&attended, &[0, (HEADS * HOTSPOT_WIDTH) as i64]);
    let mut hidden = b.graph.concat(&[&attended, &neighbours, &own], 1);
    hidden = b.linear(&hidden);
    while b.weights.len() > 0 {
        hidden = b.relu(&hidden);
        hidden = b.linear(&hidden);
    }
    hidden
}
