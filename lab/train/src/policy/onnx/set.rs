//! The set actor as a graph: the function of `network::set::actor`, from the bare observation on.
//!
//! What that module works out in plain loops, or leaves out because it cancels, is written out
//! here.

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

    /// The size of the fleet as a column with a row for each observation.
    fn fleet_size(&mut self, input: &Value, shape: &Shape) -> Value {
        let first = self.graph.columns(input, 0, 1);
        let zero = self.scaled(&first, 0.0);
        let size = self.graph.constant(&[1, 1], &[shape.agents as f32 / CROWD]);
        self.graph.binary("Add", &zero, &size)
    }

    /// The neighbours without any slot: zeros, and the weights that encode slots are passed over.
    fn no_neighbours(&mut self, input: &Value, distance: &Value) -> (Value, Value, Value) {
        self.weights.by_ref().take(4).for_each(drop);
        let none = self.scaled(distance, 0.0);
        let zero_row = self.graph.constant(&[1, UAV_WIDTH], &[0.0; UAV_WIDTH]);
        let first = self.graph.columns(input, 0, 1);
        let zero = self.scaled(&first, 0.0);
        (
            self.graph.binary("Add", &zero, &zero_row),
            none.clone(),
            none,
        )
    }

    /// The sum of the neighbours' encodings, and the crowd at and around each hotspot.
    fn neighbours(
        &mut self,
        slots: &Value,
        [hotspot_x, hotspot_y]: [&Value; 2],
        shape: &Shape,
    ) -> (Value, Value, Value) {
        let present = self.field(slots, 0);
        let embedded = self.linear(slots);
        let embedded = self.relu(&embedded);
        let embedded = self.linear(&embedded);
        let embedded = self.relu(&embedded);
        let embedded = self.graph.binary("Mul", &embedded, &present);
        let (slot_x, slot_y) = (self.field(slots, 1), self.field(slots, 2));
        let (slot_x, slot_y) = (self.graph.swap(&slot_x), self.graph.swap(&slot_y));
        let dx = self.graph.binary("Sub", hotspot_x, &slot_x);
        let dy = self.graph.binary("Sub", hotspot_y, &slot_y);
        let apart = self.distance(&dx, &dy, shape);
        let present = self.graph.swap(&present);
        let mut count = |reach: f32| {
            let near = self.nearness(&apart, reach);
            let near = self.graph.binary("Mul", &near, &present);
            let sum = self.graph.sum(&near, 2, true);
            self.scaled(&sum, 1.0 / CROWD)
        };
        let (at, around) = (count(1.0), count(4.0));
        (self.pool(&embedded), at, around)
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
        let size = b.fleet_size(&input, shape);
        b.graph.concat(&[&head, &tail, &size], 1)
    } else {
        b.graph.concat(&[&head, &tail], 1)
    };

    let (hotspot_x, hotspot_y) = (b.field(&hotspots, 0), b.field(&hotspots, 1));
    let distance = b.distance(&hotspot_x, &hotspot_y, shape);
    let (neighbours, at, around) = if k == 0 {
        b.no_neighbours(&input, &distance)
    } else {
        let slots = b.set_of(&input, slots_first, k, SLOT_FIELDS);
        b.neighbours(&slots, [&hotspot_x, &hotspot_y], shape)
    };

    let [x_cells, _] = shape.position_cells();
    let far = b.scaled(&distance, 1.0 / (2.0 * x_cells));
    let (here, near) = (b.nearness(&distance, 1.0), b.nearness(&distance, 4.0));
    let features = [&hotspots, &far, &here, &near, &at, &around];
    let features = b.graph.concat(&features, 2);
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
