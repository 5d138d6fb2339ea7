//! jcas as a Functional Mock-up Unit (FMU) for Co-Simulation by the FMI 3.0 standard (Modelica
//! Association, 2022).
//!
//! - [`variables`] is the table of variables, which the description and every get and set use.
//! - [`description`] writes that table as `modelDescription.xml`.
//! - [`setup`] has the parameters, and [`episode`] has the episode that runs with them.
//! - [`error`] has the reasons why a call is refused.
//! - [`values`] has the values of variables and of outputs.
//! - [`instance`] is the life cycle of an instance, from instantiation to termination.
//! - [`handle`] is an instance behind the importer's pointer.
//! - [`interface`] (instances and steps), [`exchange`] (variables), [`states`] and [`refused`]
//!   (what is not offered) export the functions of the standard. They and [`handle`] have the only
//!   `unsafe` code.
//!
//! `cargo xtask fmu` packs it all into `jcas.fmu`.

#![deny(unsafe_code)]

pub mod description;
pub mod episode;
pub mod error;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod exchange;
#[allow(unsafe_code)]
pub mod handle;
pub mod instance;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod interface;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod refused;
pub mod setup;
#[allow(unsafe_code, non_snake_case, clippy::not_unsafe_ptr_arg_deref)]
pub mod states;
pub mod values;
pub mod variables;
