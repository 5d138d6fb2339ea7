//! Fully connected layers with ReLU between them.

use burn_tensor::Tensor;
use burn_tensor::activation::relu;

pub(super) fn blocks(sizes: &[usize]) -> Vec<(String, usize, usize)> {
    let layers = sizes.windows(2).enumerate();
    layers
        .flat_map(|(layer, pair)| {
            [
                (format!("{layer}.weight"), pair[0], pair[1]),
                (format!("{layer}.bias"), 1, pair[1]),
            ]
        })
        .collect()
}

/// Applies weight-bias pairs in order, ReLU after each but the last.
pub(super) fn forward(weights: &[Tensor<2>], input: Tensor<2>) -> Tensor<2> {
    let last = weights.len() / 2 - 1;
    let mut hidden = input;
    for (layer, pair) in weights.chunks_exact(2).enumerate() {
        hidden = hidden.matmul(pair[0].clone()) + pair[1].clone();
        if layer < last {
            hidden = relu(hidden);
        }
    }
    hidden
}

#[cfg(test)]
mod tests {
    use crate::environment::Shape;
    use crate::network::{Architecture, Network, flat_gradient, values};
    use burn_tensor::Device;

    fn tiny() -> (Network, Vec<f32>) {
        let network = Network::new(Architecture::Mlp {
            sizes: vec![2, 2, 1],
        });
        // W0 = [[1, -1], [2, 1]], b0 = [0, 1], W1 = [[3], [-2]], b1 = [0.5].
        (network, vec![1.0, -1.0, 2.0, 1.0, 0.0, 1.0, 3.0, -2.0, 0.5])
    }

    // x = (1, 1): hidden = relu(3, 1) = (3, 1); y = 9 - 2 + 0.5 = 7.5.
    // x = (-1, 0): hidden = relu(-1, 2) = (0, 2); y = -4 + 0.5 = -3.5.
    #[test]
    fn forward_by_hand() {
        let (network, parameters) = tiny();
        let device = Device::flex();
        let weights = network.tensors(&parameters, &device);
        let input = vec![1.0, 1.0, -1.0, 0.0];
        let output = network.forward(&weights, input, &Shape::default());
        assert_eq!(values(output), [7.5, -3.5]);
    }

    // dy/dθ at x = (1, 1), both hidden units active: dW0 = x·W1ᵀ, db0 = W1, dW1 = hidden, db1 = 1.
    #[test]
    fn gradient_by_hand() {
        let (network, parameters) = tiny();
        let device = Device::flex().autodiff();
        let weights = network.tensors(&parameters, &device);
        let input = vec![1.0, 1.0];
        let loss = network.forward(&weights, input, &Shape::default()).sum();
        let gradient = flat_gradient(&network, &weights, loss.backward());
        assert_eq!(gradient, [3.0, -2.0, 3.0, -2.0, 3.0, -2.0, 3.0, 1.0, 1.0]);
    }
}
