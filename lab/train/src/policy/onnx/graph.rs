//! Building ONNX graphs: the few messages of `onnx.proto` that an inference graph needs.
//!
//! Opset 17. Every operation returns the name of its result, so a forward pass reads as it does
//! with tensors.

use prost::Message;

const OPSET: i64 = 17;
const IR_VERSION: i64 = 8;
const FLOAT: i32 = 1;
const INT64: i32 = 7;

#[derive(Clone, PartialEq, Message)]
struct ModelProto {
    #[prost(int64, tag = "1")]
    ir_version: i64,
    #[prost(string, tag = "2")]
    producer_name: String,
    #[prost(message, optional, tag = "7")]
    graph: Option<GraphProto>,
    #[prost(message, repeated, tag = "8")]
    opset_import: Vec<OperatorSetId>,
}

#[derive(Clone, PartialEq, Message)]
struct OperatorSetId {
    #[prost(string, tag = "1")]
    domain: String,
    #[prost(int64, tag = "2")]
    version: i64,
}

#[derive(Clone, PartialEq, Message)]
struct GraphProto {
    #[prost(message, repeated, tag = "1")]
    node: Vec<NodeProto>,
    #[prost(string, tag = "2")]
    name: String,
    #[prost(message, repeated, tag = "5")]
    initializer: Vec<TensorProto>,
    #[prost(message, repeated, tag = "11")]
    input: Vec<ValueInfo>,
    #[prost(message, repeated, tag = "12")]
    output: Vec<ValueInfo>,
}

#[derive(Clone, PartialEq, Message)]
struct NodeProto {
    #[prost(string, repeated, tag = "1")]
    input: Vec<String>,
    #[prost(string, repeated, tag = "2")]
    output: Vec<String>,
    #[prost(string, tag = "4")]
    op_type: String,
    #[prost(message, repeated, tag = "5")]
    attribute: Vec<Attribute>,
}

#[derive(Clone, PartialEq, Message)]
struct Attribute {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(int64, optional, tag = "3")]
    i: Option<i64>,
    #[prost(int64, repeated, packed = "false", tag = "8")]
    ints: Vec<i64>,
    #[prost(int32, tag = "20")]
    kind: i32,
}

const ATTRIBUTE_INT: i32 = 2;
const ATTRIBUTE_INTS: i32 = 7;

#[derive(Clone, PartialEq, Message)]
struct TensorProto {
    #[prost(int64, repeated, packed = "false", tag = "1")]
    dims: Vec<i64>,
    #[prost(int32, tag = "2")]
    data_type: i32,
    #[prost(string, tag = "8")]
    name: String,
    #[prost(bytes = "vec", tag = "9")]
    raw_data: Vec<u8>,
}

#[derive(Clone, PartialEq, Message)]
struct ValueInfo {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(message, optional, tag = "2")]
    kind: Option<TypeProto>,
}

#[derive(Clone, PartialEq, Message)]
struct TypeProto {
    #[prost(message, optional, tag = "1")]
    tensor_type: Option<TensorType>,
}

#[derive(Clone, PartialEq, Message)]
struct TensorType {
    #[prost(int32, tag = "1")]
    elem_type: i32,
    #[prost(message, optional, tag = "2")]
    shape: Option<ShapeProto>,
}

#[derive(Clone, PartialEq, Message)]
struct ShapeProto {
    #[prost(message, repeated, tag = "1")]
    dim: Vec<Dimension>,
}

#[derive(Clone, PartialEq, Message)]
struct Dimension {
    #[prost(int64, optional, tag = "1")]
    dim_value: Option<i64>,
    #[prost(string, optional, tag = "2")]
    dim_param: Option<String>,
}

/// The result of an operation.
#[derive(Clone, Debug)]
pub(super) struct Value(String);

/// A graph under construction.
pub(super) struct Graph {
    proto: GraphProto,
    names: usize,
}

/// A matrix of f32 with free rows.
fn rows_of(name: &str, columns: usize) -> ValueInfo {
    let rows = Dimension {
        dim_value: None,
        dim_param: Some("rows".to_owned()),
    };
    let columns = Dimension {
        dim_value: Some(columns as i64),
        dim_param: None,
    };
    let shape = Some(ShapeProto {
        dim: vec![rows, columns],
    });
    let tensor_type = Some(TensorType {
        elem_type: FLOAT,
        shape,
    });
    ValueInfo {
        name: name.to_owned(),
        kind: Some(TypeProto { tensor_type }),
    }
}

impl Graph {
    pub(super) fn new(name: &str) -> Graph {
        Graph {
            proto: GraphProto {
                name: name.to_owned(),
                ..GraphProto::default()
            },
            names: 0,
        }
    }

    fn name(&mut self) -> String {
        self.names += 1;
        format!("v{}", self.names)
    }

    pub(super) fn input(&mut self, name: &str, columns: usize) -> Value {
        self.proto.input.push(rows_of(name, columns));
        Value(name.to_owned())
    }

    /// Gives a value its public name.
    pub(super) fn output(&mut self, value: &Value, name: &str, columns: usize) {
        self.proto.node.push(NodeProto {
            input: vec![value.0.clone()],
            output: vec![name.to_owned()],
            op_type: "Identity".to_owned(),
            attribute: Vec::new(),
        });
        self.proto.output.push(rows_of(name, columns));
    }

    fn initializer(&mut self, dims: &[usize], data_type: i32, raw_data: Vec<u8>) -> Value {
        let name = self.name();
        self.proto.initializer.push(TensorProto {
            dims: dims.iter().map(|&dim| dim as i64).collect(),
            data_type,
            name: name.clone(),
            raw_data,
        });
        Value(name)
    }

    pub(super) fn constant(&mut self, dims: &[usize], values: &[f32]) -> Value {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.initializer(dims, FLOAT, bytes)
    }

    fn integers(&mut self, values: &[i64]) -> Value {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.initializer(&[values.len()], INT64, bytes)
    }

    fn node(&mut self, op_type: &str, inputs: &[&Value], attribute: Vec<Attribute>) -> Value {
        let name = self.name();
        self.proto.node.push(NodeProto {
            input: inputs.iter().map(|value| value.0.clone()).collect(),
            output: vec![name.clone()],
            op_type: op_type.to_owned(),
            attribute,
        });
        Value(name)
    }

    /// Any operation with integer attributes.
    pub(super) fn op(
        &mut self,
        op_type: &str,
        inputs: &[&Value],
        integers: &[(&str, i64)],
    ) -> Value {
        let attributes = integers
            .iter()
            .map(|&(name, i)| Attribute {
                name: name.to_owned(),
                i: Some(i),
                ints: Vec::new(),
                kind: ATTRIBUTE_INT,
            })
            .collect();
        self.node(op_type, inputs, attributes)
    }

    pub(super) fn binary(&mut self, op_type: &str, a: &Value, b: &Value) -> Value {
        self.op(op_type, &[a, b], &[])
    }

    /// x·W + b.
    pub(super) fn linear(&mut self, x: &Value, weight: &Value, bias: &Value) -> Value {
        let product = self.binary("MatMul", x, weight);
        self.binary("Add", &product, bias)
    }

    /// Columns `from..to` of a matrix.
    pub(super) fn columns(&mut self, matrix: &Value, from: usize, to: usize) -> Value {
        self.slice(matrix, 1, from, to)
    }

    /// Indices `from..to` along an axis.
    pub(super) fn slice(&mut self, value: &Value, axis: i64, from: usize, to: usize) -> Value {
        let from = self.integers(&[from as i64]);
        let to = self.integers(&[to as i64]);
        let axis = self.integers(&[axis]);
        self.op("Slice", &[value, &from, &to, &axis], &[])
    }

    /// A new shape; 0 keeps a dimension, -1 takes what is left.
    pub(super) fn reshape(&mut self, value: &Value, shape: &[i64]) -> Value {
        let shape = self.integers(shape);
        self.op("Reshape", &[value, &shape], &[])
    }

    /// Swaps the last two of three dimensions.
    pub(super) fn swap(&mut self, value: &Value) -> Value {
        let attribute = Attribute {
            name: "perm".to_owned(),
            i: None,
            ints: vec![0, 2, 1],
            kind: ATTRIBUTE_INTS,
        };
        self.node("Transpose", &[value], vec![attribute])
    }

    /// Sum along an axis, which stays with length 1 where `keep`.
    pub(super) fn sum(&mut self, value: &Value, axis: i64, keep: bool) -> Value {
        let axis = self.integers(&[axis]);
        self.op(
            "ReduceSum",
            &[value, &axis],
            &[("keepdims", i64::from(keep))],
        )
    }

    pub(super) fn concat(&mut self, values: &[&Value], axis: i64) -> Value {
        self.op("Concat", values, &[("axis", axis)])
    }

    /// Index of the first largest column, as f32, rows × 1.
    pub(super) fn arg_max(&mut self, matrix: &Value) -> Value {
        let index = self.op("ArgMax", &[matrix], &[("axis", 1), ("keepdims", 1)]);
        self.op("Cast", &[&index], &[("to", i64::from(FLOAT))])
    }

    pub(super) fn encode(self) -> Vec<u8> {
        ModelProto {
            ir_version: IR_VERSION,
            producer_name: "jcas".to_owned(),
            graph: Some(self.proto),
            opset_import: vec![OperatorSetId {
                domain: String::new(),
                version: OPSET,
            }],
        }
        .encode_to_vec()
    }
}
