//! The same flight in an ordinary program: what `jcas-no-std` prints has to be what this prints.

#[path = "../src/flight.rs"]
mod flight;

fn main() {
    match flight::fly() {
        Ok(hash) => println!("{hash:#018x}"),
        Err(error) => panic!("{error}"),
    }
}
