//! The digests that pin the definition of the points. They must never change: if one changes, the program computes
//! other points.

use tilescope_core::{Boundary, Insertion, Order, Parameters, PatternSpec, Variant};

/// Runs of every kind, by name.
pub fn cases() -> Vec<(&'static str, Parameters)> {
    let base = Parameters {
        radius: 0.01,
        ..Parameters::default()
    };
    let bounded = Parameters {
        boundary: Boundary::Bounded,
        width: 1.7,
        seed: u64::MAX,
        ..base
    };
    let pattern = PatternSpec {
        side: 23.5,
        boundary: Boundary::Periodic,
        seed: 5,
    };
    vec![
        ("default", Parameters::default()),
        (
            "index",
            Parameters {
                order: Order::Index,
                ..base
            },
        ),
        (
            "random",
            Parameters {
                order: Order::Random,
                ..base
            },
        ),
        (
            "phase groups",
            Parameters {
                order: Order::PhaseGroup,
                ..base
            },
        ),
        (
            "dihedral",
            Parameters {
                dihedral: true,
                leaf: 6.0,
                pattern,
                ..base
            },
        ),
        ("bounded", bounded),
        (
            "uniform",
            Parameters {
                insertion: Insertion::Uniform,
                ..bounded
            },
        ),
        (
            "as printed",
            Parameters {
                variant: Variant::AsPrinted,
                ..bounded
            },
        ),
    ]
}

/// Their digests, and that of the reference sampler's set of the default domain with seed 1.
pub const PINNED: [(&str, &str); 9] = [
    (
        "default",
        "blake3:bf403d0a9619fb4eae18c386324b52946563131fdb42d11b686906a87895c5b0",
    ),
    (
        "index",
        "blake3:430e2ac82bd27cde529a5eedc7e86fca6a3e0040b8c6b78e35a8770fe9ca224f",
    ),
    (
        "random",
        "blake3:eb77df0e151479f3b455a1cb36f8d9dead1266d9191513ce6fc758b1eeeecd26",
    ),
    (
        "phase groups",
        "blake3:fe885a4cb0bf1306ec5370eff6f4f10540d521c91d1570dfbd033743dc68784a",
    ),
    (
        "dihedral",
        "blake3:a03de5c2489b365787c2b817f860d5d3b05bdb1e617c6d45c9959e71106715d4",
    ),
    (
        "bounded",
        "blake3:e6c60dc27ec722d79b43a7bd42223ed115ef95a3ad15a2d7954d72c80229802e",
    ),
    (
        "uniform",
        "blake3:6dc38c60bee099d03fd6525e141204a53e09f74577be402b3e24c59c79690b7d",
    ),
    (
        "as printed",
        "blake3:cdb0804bcadfacbf4cd018db14040d1f7deb76001e353c3221acaf341b66336b",
    ),
    (
        "reference",
        "blake3:827cd8400ab05b1576b4b726356bd17c224db98902f433465117138169660b33",
    ),
];

/// The digest of the exact tiling of the default run, with the pattern that goes with it.
pub const EXACT: (&str, &str) = (
    "exact",
    "blake3:73bb3b7df18f482dce21dd2183c8b98fab9d6c6b36a734297259dce0a9709864",
);

/// The digests of nested levels: 5 levels of the default run in the order drawn and by distance, and 4 of a bounded run.
pub const NESTED: [&str; 3] = [
    "blake3:68acda5a536fea17ba56e1339d298cf68b7171455ca7775fd93b9c0295ce0dfe",
    "blake3:9c28ddce70200dabf2b0c620d799840a59aab08705709b3d13dc792aec0dd967",
    "blake3:ba829e8d9db3f2d4ee07814a7630c45e37fdfa95139893acfede4013fa417083",
];
