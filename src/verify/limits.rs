//! Limits of a user's WGSL: what compilers nest without an end to their stacks, what drivers compile within a minute, and the
//! turns of loops that they run.
//!
//! Compilers follow the nesting of an expression by recursion, and `a + b + c + …` nests once a term. Drivers put the body of
//! a function in place of each call, so that forty functions that call their predecessor twice are 2⁴⁰ bodies. Some drivers stop
//! the loops of an invocation after 65,535 turns and say nothing.

use crate::base::error::{Error, Result};
use naga::{
    BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, Module, Range, Span,
    Statement,
};
use std::panic::resume_unwind;
use std::thread;

/// Bytes of a file.
const LONGEST: usize = 1 << 22;
/// Operators, brackets and members that follow each other within one expression.
const NESTING: usize = 1 << 17;
/// Branches `else` of a file, each of which may stand in the one before. Software Vulkan takes minutes for ten thousand.
const BRANCHES: usize = 1 << 10;
/// Bytes of the stack on which a file is compiled: 2 KiB for each level.
const STACK: usize = NESTING << 11;
/// Operations of a function with all calls in place. Software Vulkan compiles so many in some ten seconds.
const OPERATIONS: u64 = 1 << 18;
/// Invocations that a driver which stops loops may run in step; it counts the turns of all of them.
const IN_STEP: u32 = 16;

/// Nesting that any stack holds.
const SHALLOW: Nesting = Nesting { operators: 1 << 10, branches: 1 << 6 };

/// Runs what follows the nesting of a text: where that is deep, on a stack that is large enough for what [`check_text`] lets
/// pass.
///
/// # Errors
/// When the system has no room for the stack; and those of `work`.
pub(super) fn with_stack<T: Send>(is_deep: bool, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    if !is_deep {
        return work();
    }
    thread::scope(|scope| {
        let compiler = thread::Builder::new().name("compiler".into()).stack_size(STACK);
        let compiler = compiler.spawn_scoped(scope, work);
        let compiler = compiler.map_err(|e| Error::Device(format!("no thread to compile WGSL on: {e}")))?;
        compiler.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Refuses a text that is too large or too deeply nested to be compiled. Returns whether it is deep.
pub(super) fn check_text(source: &str) -> Result<bool> {
    if source.len() > LONGEST {
        let mib = LONGEST >> 20;
        return Err(Error::input(format!("it has more than {mib} MiB; give the BRDF a file of its own")));
    }
    let Nesting { operators: nesting, branches } = nesting(source);
    if branches > BRANCHES {
        return Err(Error::input(format!(
            "it has {branches} branches `else`, and {BRANCHES} at most are compiled; use `switch`, or a file for each BRDF"
        )));
    }
    if nesting > NESTING {
        return Err(Error::input(format!(
            "an expression nests {nesting} operators, and {NESTING} at most are compiled; split it over several statements"
        )));
    }
    Ok(nesting > SHALLOW.operators || branches > SHALLOW.branches)
}

/// How deeply a text may nest.
struct Nesting {
    operators: usize,
    branches: usize,
}

/// An upper bound of how deeply an expression nests: its operators, brackets and members in a row. An `else if` nests too.
fn nesting(source: &str) -> Nesting {
    /// What stands between a bracket and its end.
    #[derive(Default)]
    struct Level {
        chain: usize,
        deepest: usize,
    }
    fn close(levels: &mut Vec<Level>) {
        if let Some(level) = levels.pop() {
            let depth = level.chain.max(level.deepest) + 1;
            match levels.last_mut() {
                Some(outer) => outer.chain += depth,
                None => levels.push(Level { chain: 0, deepest: depth }),
            }
        }
    }
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_' || *byte >= 128;
    let mut levels = vec![Level::default()];
    let (mut deepest, mut branches) = (0, 0);
    let mut rest = source.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let length = rest.iter().take_while(|byte| is_word(byte)).count();
        if length > 0 {
            branches += usize::from(&rest[..length] == b"else");
            rest = &rest[length..];
            continue;
        }
        rest = after;
        let Some(level) = levels.last_mut() else { break };
        match byte {
            b'/' if after.starts_with(b"/") => {
                let end = after.iter().position(|&byte| byte == b'\n').unwrap_or(after.len());
                rest = &after[end..];
            }
            b'/' if after.starts_with(b"*") => rest = after_comment(&after[1..]),
            b'(' | b'[' => levels.push(Level::default()),
            b')' | b']' => close(&mut levels),
            b',' => *level = Level { chain: 0, deepest: level.deepest.max(level.chain) },
            b';' | b'{' | b'}' => {
                while levels.len() > 1 {
                    close(&mut levels);
                }
                deepest =
                    levels.drain(..).map(|level| level.chain.max(level.deepest)).fold(deepest, usize::max);
                levels.push(Level::default());
            }
            _ if byte.is_ascii_whitespace() => {}
            _ => level.chain += 1,
        }
    }
    while levels.len() > 1 {
        close(&mut levels);
    }
    let last = levels.pop().map_or(0, |level| level.chain.max(level.deepest));
    Nesting { operators: deepest.max(last), branches }
}

/// What follows a block comment, which may hold others.
fn after_comment(mut rest: &[u8]) -> &[u8] {
    let mut open = 1;
    while open > 0 {
        match rest {
            [b'/', b'*', after @ ..] => (open, rest) = (open + 1, after),
            [b'*', b'/', after @ ..] => (open, rest) = (open - 1, after),
            [_, after @ ..] => rest = after,
            [] => break,
        }
    }
    rest
}

/// A function with the body of another in place of each call.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inlined {
    operations: u64,
    /// Whether it has a loop.
    pub loops: bool,
}

impl Inlined {
    /// Puts all calls of a function in place, by counts.
    ///
    /// # Errors
    /// When it has more operations than a driver compiles.
    pub fn new(module: &Module, function: Handle<Function>) -> Result<Self> {
        let mut functions: Vec<Self> = Vec::new();
        // A function stands after those that it calls.
        for (_, callee) in module.functions.iter() {
            let mut inlined = Self { operations: callee.expressions.len() as u64, loops: false };
            inlined.add(&callee.body, &functions);
            functions.push(inlined);
        }
        let inlined = functions[function.index()];
        if inlined.operations > OPERATIONS {
            let name = module.functions[function].name.as_deref().unwrap_or("the function");
            return Err(Error::input(format!(
                "fn {name} has {} operations, with the function called in place of each call as drivers have it, and {OPERATIONS} \
                 at most are compiled; call a function once and keep its result, or loop",
                if inlined.operations == u64::MAX {
                    "2⁶⁴ or more".into()
                } else {
                    inlined.operations.to_string()
                }
            )));
        }
        Ok(inlined)
    }

    fn add(&mut self, block: &Block, functions: &[Self]) {
        for statement in block {
            match statement {
                Statement::Call { function, .. } => {
                    let callee = functions.get(function.index()).copied().unwrap_or_default();
                    self.operations = self.operations.saturating_add(callee.operations);
                    self.loops |= callee.loops;
                }
                Statement::Loop { body, continuing, .. } => {
                    self.loops = true;
                    self.add(body, functions);
                    self.add(continuing, functions);
                }
                Statement::Block(block) => self.add(block, functions),
                Statement::If { accept, reject, .. } => {
                    self.add(accept, functions);
                    self.add(reject, functions);
                }
                Statement::Switch { cases, .. } => {
                    cases.iter().for_each(|case| self.add(&case.body, functions))
                }
                _ => {}
            }
        }
    }
}

/// The turns of one invocation's loops that run for certain where a driver stops loops after `turns` of those in step.
pub(super) fn certain_turns(turns: u32) -> u32 {
    turns / IN_STEP
}

/// Lets every loop count its turns, in the private variable of this name.
pub(super) fn count_turns(module: &mut Module, counter: &str) {
    let is_counter = |variable: &GlobalVariable| variable.name.as_deref() == Some(counter);
    let Some((counter, _)) = module.global_variables.iter().find(|(_, variable)| is_counter(variable)) else {
        return;
    };
    let functions = module.functions.iter_mut().map(|(_, function)| function);
    for function in functions.chain(module.entry_points.iter_mut().map(|point| &mut point.function)) {
        let mut body = std::mem::take(&mut function.body);
        count_in(&mut body, function, counter);
        function.body = body;
    }
}

fn count_in(block: &mut Block, function: &mut Function, counter: Handle<GlobalVariable>) {
    for statement in block.iter_mut() {
        match statement {
            Statement::Loop { body, continuing, .. } => {
                count_in(body, function, counter);
                count_in(continuing, function, counter);
                let mut counted = one_more(function, counter);
                counted.append(body);
                *body = counted;
            }
            Statement::Block(block) => count_in(block, function, counter),
            Statement::If { accept, reject, .. } => {
                count_in(accept, function, counter);
                count_in(reject, function, counter);
            }
            Statement::Switch { cases, .. } => {
                cases.iter_mut().for_each(|case| count_in(&mut case.body, function, counter))
            }
            _ => {}
        }
    }
}

/// `counter += 1u;`
fn one_more(function: &mut Function, counter: Handle<GlobalVariable>) -> Block {
    let mut add = |expression| function.expressions.append(expression, Span::UNDEFINED);
    let pointer = add(Expression::GlobalVariable(counter));
    let right = add(Expression::Literal(Literal::U32(1)));
    let left = add(Expression::Load { pointer });
    let value = add(Expression::Binary { op: BinaryOperator::Add, left, right });
    let range = Range::new_from_bounds(left, value);
    Block::from_vec(vec![Statement::Emit(range), Statement::Store { pointer, value }])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nesting_is_counted_within_one_expression() {
        let operators = |source: &str| nesting(source).operators;
        assert!(operators("let a = 1e-9 + b; let c = d;") < 5);
        assert_eq!(operators(&format!("let a = b{};", " + b".repeat(1000))), 1001); // and the `=`
        // Lists are flat; brackets and what stands after them are deep.
        assert!(operators(&format!("let a = array({});", "b + c, ".repeat(1000))) < 10);
        assert!(operators(&format!("let a = {}b{};", "f(".repeat(100), " + c, d)".repeat(100))) >= 200);
        assert_eq!(nesting(&"if a { } else ".repeat(1000)).branches, 1000);
        assert!(operators(&"// +++ /*\n/* --- /* --- */ --- */".repeat(1000)) < 5);
    }

    #[test]
    fn calls_are_counted_without_being_followed() {
        let mut source = String::from("fn tree0(x: f32) -> f32 { return x; }\n");
        for k in 1..=80 {
            source +=
                &format!("fn tree{k}(x: f32) -> f32 {{ return tree{}(x) + tree{}(x); }}\n", k - 1, k - 1);
        }
        let module = naga::front::wgsl::parse_str(&source).unwrap();
        let find =
            |name: &str| module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name)).unwrap().0;
        assert!(!Inlined::new(&module, find("tree8")).unwrap().loops);
        let error = |name| Inlined::new(&module, find(name)).unwrap_err().to_string();
        assert!(error("tree40").contains("fn tree40 has "), "{}", error("tree40"));
        assert!(error("tree80").contains("2⁶⁴ or more"), "{}", error("tree80"));
    }
}
