//! The same mission in an ordinary program, which has to print what `jcas-no-std` prints.

#[path = "../src/flight.rs"]
mod flight;

fn main() {
    match flight::fly() {
        Ok(hash) => println!("{hash:#018x}"),
        Err(error) => panic!("{error}"),
    }
}
