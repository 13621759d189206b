//! Motions and configurations that cannot be meant cannot be written down: programs
//! that must not compile, with what the compiler says, and their right forms.

/// The messages belong to one compiler; with another one only the right forms are built.
const MESSAGES_OF: &str = "rustc 1.95.";

#[test]
fn what_cannot_be_meant_does_not_compile() {
    let programs = trybuild::TestCases::new();
    // Besides, a program that must run makes trybuild build the others instead of
    // checking them: assertions on types are evaluated only then.
    programs.pass("pass/*.rs");
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let version = std::process::Command::new(compiler)
        .arg("--version")
        .output();
    let version = String::from_utf8(version.expect("a compiler").stdout).expect("a version");
    if version.starts_with(MESSAGES_OF) {
        programs.compile_fail("fail/*.rs");
    } else {
        println!("messages not compared: they are those of {MESSAGES_OF}x, this is {version}");
    }
}
