//! The bill of materials, in the format CycloneDX 1.5 (<https://cyclonedx.org>).

use serde_json::{Value, json};

use super::dependencies::{CargoPackage, Graph};

/// The bill of all packages in the binaries, as JSON. It has no time and no serial number, so that
/// it depends on the graph alone.
pub fn cyclonedx(graph: &Graph, version: &str) -> String {
    let components: Vec<Value> = graph.keys().map(component).collect();
    let reference = |id: &str| {
        let package = graph.keys().find(|package| package.id == id);
        package.map(package_url)
    };
    let dependencies: Vec<Value> = graph
        .iter()
        .map(|(package, depends_on)| {
            let depends_on: Vec<String> =
                depends_on.iter().filter_map(|id| reference(id)).collect();
            json!({"ref": package_url(package), "dependsOn": depends_on})
        })
        .collect();
    let bill = json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": {"type": "library", "name": "jcas", "version": version}},
        "components": components,
        "dependencies": dependencies,
    });
    format!("{bill:#}\n")
}

fn component(package: &CargoPackage) -> Value {
    let url = package_url(package);
    let mut component = json!({
        "type": "library",
        "bom-ref": url,
        "purl": url,
        "name": package.name,
        "version": package.version,
    });
    if let Some(license) = &package.license {
        // The older form of a choice is no SPDX expression.
        let expression = license.replace('/', " OR ");
        component["licenses"] = json!([{"expression": expression}]);
    }
    component
}

fn package_url(package: &CargoPackage) -> String {
    format!("pkg:cargo/{}@{}", package.name, package.version)
}
