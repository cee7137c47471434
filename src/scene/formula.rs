//! Weights as polynomials in a material's quantities: numbers if those are constant, else formulas in text.

use std::fmt;

/// A sum of products of quantities, of their complements to 1 and of numbers, for R, G and B.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Formula(Vec<Monomial>);

#[derive(Debug, Clone, PartialEq)]
struct Monomial {
    number: f64,
    terms: Vec<FormulaTerm>,
}

/// A material's quantity: its factor, and the least value that textures leave of it.
#[derive(Debug, Clone, PartialEq)]
pub struct FormulaInput {
    /// What formulas call it.
    pub name: &'static str,
    /// Its largest values in R, G and B, in [0, 1].
    pub value: [f64; 3],
    /// The least value where it differs from place to place.
    pub least: Option<f64>,
}

/// x, max(x) over the channels, or what either leaves of 1.
#[derive(Debug, Clone, PartialEq)]
struct FormulaTerm {
    of: FormulaInput,
    is_max: bool,
    is_rest: bool,
}

/// Formulas name these even where they do not vary.
const ALWAYS_NAMED: [&str; 2] = ["metallic", "base_color"];

impl FormulaInput {
    /// One that is the same everywhere and in all channels.
    pub fn constant(name: &'static str, value: f64) -> Self {
        Self { name, value: [value; 3], least: None }
    }

    /// x
    pub fn all(&self) -> Formula {
        self.term(false, false)
    }

    /// 1 − x
    pub fn rest(&self) -> Formula {
        self.term(false, true)
    }

    /// max(x)
    pub fn max(&self) -> Formula {
        self.term(true, false)
    }

    /// 1 − max(x)
    pub fn rest_of_max(&self) -> Formula {
        self.term(true, true)
    }

    /// The range that it takes over places and channels.
    pub fn range(&self) -> [f64; 2] {
        let [low, high] = [f64::min, f64::max].map(|f| self.value.into_iter().reduce(f).unwrap_or(1.0));
        [self.least.unwrap_or(low), high]
    }

    /// Whether it differs from place to place.
    pub fn varies(&self) -> bool {
        self.least.is_some()
    }

    fn term(&self, is_max: bool, is_rest: bool) -> Formula {
        Formula(vec![Monomial {
            number: 1.0,
            terms: vec![FormulaTerm { of: self.clone(), is_max, is_rest }],
        }])
    }
}

impl Formula {
    /// Builds a constant.
    pub fn number(number: f64) -> Self {
        Self(vec![Monomial { number, terms: Vec::new() }])
    }

    /// Adds two formulas.
    pub fn plus(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }

    /// Multiplies two formulas.
    pub fn times(&self, other: &Self) -> Self {
        let product = |a: &Monomial, b: &Monomial| Monomial {
            number: a.number * b.number,
            terms: a.terms.iter().chain(&b.terms).cloned().collect(),
        };
        Self(self.0.iter().flat_map(|a| other.0.iter().map(move |b| product(a, b))).collect())
    }

    /// Whether a quantity in it varies.
    pub fn varies(&self) -> bool {
        self.inputs().any(FormulaInput::varies)
    }

    /// Whether it is 0 whatever textures hold.
    pub fn is_zero(&self) -> bool {
        self.0.iter().all(Monomial::is_zero) || !self.varies() && self.value() == [0.0; 3]
    }

    /// Returns R, G and B if no texture varies.
    pub fn value(&self) -> [f64; 3] {
        self.at(&|_| None)
    }

    /// Evaluates R, G and B with these values for some quantities, and the stored values for the others.
    pub fn at(&self, given: &dyn Fn(&str) -> Option<f64>) -> [f64; 3] {
        let evaluate = |term: &FormulaTerm| term.of(given(term.of.name).map_or(term.of.value, |x| [x; 3]));
        let product = |product: &Monomial| {
            product
                .terms
                .iter()
                .map(evaluate)
                .fold([product.number; 3], |a, b| [0, 1, 2].map(|c| a[c] * b[c]))
        };
        // The first as it is: 0 + x is x, but −0.
        self.0.iter().map(product).reduce(|a, b| [0, 1, 2].map(|c| a[c] + b[c])).unwrap_or_default()
    }

    /// Returns its largest possible value.
    pub fn maximum(&self) -> f64 {
        let product =
            |p: &Monomial| p.terms.iter().map(FormulaTerm::maximum).fold(p.number.max(0.0), |a, b| a * b);
        self.0.iter().map(product).sum()
    }

    /// The quantities in it.
    pub fn inputs(&self) -> impl Iterator<Item = &FormulaInput> {
        self.0.iter().filter(|p| p.number() != 0.0).flat_map(|p| p.terms.iter().map(|term| &term.of))
    }
}

impl Monomial {
    /// The number that stands before its words.
    fn number(&self) -> f64 {
        self.terms.iter().filter_map(FormulaTerm::folded).fold(self.number, |a, b| a * b)
    }

    fn is_zero(&self) -> bool {
        let constant = |term: &&FormulaTerm| !term.of.varies();
        self.number == 0.0 || self.terms.iter().filter(constant).any(|t| t.of(t.of.value) == [0.0; 3])
    }
}

impl FormulaTerm {
    fn of(&self, value: [f64; 3]) -> [f64; 3] {
        let max = value.into_iter().fold(0.0, f64::max);
        let value = if self.is_max { [max; 3] } else { value };
        if self.is_rest { value.map(|x| 1.0 - x) } else { value }
    }

    fn maximum(&self) -> f64 {
        let [low, high] = self.of.range();
        if self.is_rest { 1.0 - low } else { high }
    }

    /// Its number where that is all there is to it.
    fn folded(&self) -> Option<f64> {
        let [r, g, b] = self.of(self.of.value);
        let named = self.of.varies() || ALWAYS_NAMED.contains(&self.of.name);
        (!named && r == g && g == b).then_some(r)
    }

    fn words(&self) -> String {
        let name = match (self.of.varies() || ALWAYS_NAMED.contains(&self.of.name), self.is_max) {
            (true, false) => self.of.name.to_owned(),
            (true, true) => format!("max({})", self.of.name),
            (false, _) => {
                let [r, g, b] = self.of(self.of.value).map(short);
                return format!("[{r}, {g}, {b}]");
            }
        };
        if self.is_rest { format!("(1 − {name})") } else { name }
    }
}

/// Six decimals, as far as there are any.
fn short(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut first = true;
        for product in self.0.iter().filter(|product| product.number() != 0.0) {
            let number = short(product.number());
            let named = product.terms.iter().filter(|term| term.folded().is_none());
            let mut words: Vec<_> = named.map(FormulaTerm::words).collect();
            if number.abs() != 1.0 || words.is_empty() {
                words.insert(0, number.abs().to_string());
            }
            f.write_str(match (first, number < 0.0) {
                (true, false) => "",
                (true, true) => "−",
                (false, false) => " + ",
                (false, true) => " − ",
            })?;
            f.write_str(&words.join(" "))?;
            first = false;
        }
        if first { f.write_str("0") } else { Ok(()) }
    }
}
