//! jcas as a Functional Mock-up Unit, by the FMI 3.0 standard for Co-Simulation (Modelica
//! Association, 2022).
//!
//! - [`variables`]: what an importer sees, one table for the description and for every get and set;
//! - [`description`]: that table as `modelDescription.xml`;
//! - [`setup`]: the parameters; [`mission`]: the flight that they make;
//! - [`instance`]: the life of an instance, from instantiation to termination;
//! - [`handle`]: an instance behind the importer's pointer; the functions of the standard, with it
//!   the only `unsafe`: [`interface`] (an instance and its steps), [`exchange`] (variables),
//!   [`states`], [`refused`] (what is not offered).
//!
//! `cargo xtask fmu` packs it all into `jcas.fmu`.

#![deny(unsafe_code)]

pub mod description;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod exchange;
#[allow(unsafe_code)]
pub mod handle;
pub mod instance;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod interface;
pub mod mission;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod refused;
pub mod setup;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod states;
pub mod variables;
