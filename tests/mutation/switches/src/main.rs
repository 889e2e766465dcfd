//! Puts mutants of a Rust file behind switches, so that one build holds them all.
//!
//! `switches SOURCE SITES OUT`: a line of SITES is `number<TAB>byte offset<TAB>new text` of a token.
//! OUT is the source in which that token is the new one while `crate::mutant(number)` holds.
//! Every operand stands in it once. The numbers that have a switch are printed; a token in a
//! constant, a pattern, a type or a generic argument has none.

use std::{cmp::Reverse, collections::HashMap, env, error::Error, fs, ops::Range};

use syn::{
    BinOp, Expr, Macro, Token, UnOp,
    parse::Parser,
    punctuated::Punctuated,
    spanned::Spanned,
    visit::{self, Visit},
};

struct Site {
    number: u32,
    new: String,
}

enum Piece {
    Text(String),
    /// Text of the source, with its own switches.
    Source(Range<usize>),
}

/// What stands in place of a range of the source.
struct Edit {
    range: Range<usize>,
    number: u32,
    pieces: Vec<Piece>,
}

struct Switches<'a> {
    whole: &'a str,
    /// By byte offset.
    sites: HashMap<usize, Site>,
    edits: Vec<Edit>,
}

fn text(text: impl Into<String>) -> Piece {
    Piece::Text(text.into())
}

fn source(node: &impl Spanned) -> Piece {
    Piece::Source(node.span().byte_range())
}

/// A chain of `&&` with a pattern in it is no expression of its own.
fn holds_let(e: &Expr) -> bool {
    match e {
        Expr::Let(_) => true,
        Expr::Binary(both) => holds_let(&both.left) || holds_let(&both.right),
        _ => false,
    }
}

impl Switches<'_> {
    /// The switch of the token at `at`, in place of `node`.
    fn switch(
        &mut self,
        at: &impl Spanned,
        node: &impl Spanned,
        pieces: impl FnOnce(&str, &str) -> Vec<Piece>,
    ) {
        let Some(site) = self.sites.get(&at.span().byte_range().start) else {
            return;
        };
        let condition = format!("crate::mutant({})", site.number);
        self.edits.push(Edit {
            range: node.span().byte_range(),
            number: site.number,
            pieces: pieces(&condition, &site.new),
        });
    }

    fn binary(&mut self, e: &syn::ExprBinary) {
        let (a, b) = (&*e.left, &*e.right);
        let old = match e.op {
            BinOp::Add(_) => "+",
            BinOp::Sub(_) => "-",
            BinOp::Mul(_) => "*",
            BinOp::Div(_) => "/",
            BinOp::And(_) | BinOp::Or(_) => {
                if holds_let(a) || holds_let(b) {
                    return;
                }
                // The first operand decides alone where it is false, or true where `&&` is `||`.
                let decides = if matches!(e.op, BinOp::And(_)) {
                    "=="
                } else {
                    "!="
                };
                return self.switch(&e.op, e, |mutant, _| {
                    vec![
                        text("({ let __a: bool = "),
                        source(a),
                        text(format!("; if __a {decides} {mutant} {{ __a }} else {{ ")),
                        source(b),
                        text(" } })"),
                    ]
                });
            }
            BinOp::Eq(_) => "==",
            BinOp::Ne(_) => "!=",
            BinOp::Lt(_) => "<",
            BinOp::Le(_) => "<=",
            BinOp::Gt(_) => ">",
            BinOp::Ge(_) => ">=",
            BinOp::AddAssign(_) => "+=",
            BinOp::SubAssign(_) => "-=",
            BinOp::MulAssign(_) => "*=",
            BinOp::DivAssign(_) => "/=",
            _ => return,
        };
        if old.len() == 2 && old.ends_with('=') && "+-*/".contains(&old[..1]) {
            // The value comes first: it may read the place.
            self.switch(&e.op, e, |mutant, new| {
                vec![
                    text("{ let __b = "),
                    source(b),
                    text("; let __a = &mut ("),
                    source(a),
                    text(format!(
                        "); if {mutant} {{ *__a {new} __b }} else {{ *__a {old} __b }} }}"
                    )),
                ]
            });
        } else if matches!(old, "+" | "-" | "*" | "/") {
            // A match keeps temporaries as long as the expression does.
            self.switch(&e.op, e, |mutant, new| {
                vec![
                    text("(match ("),
                    source(a),
                    text(", "),
                    source(b),
                    text(format!(
                        ") {{ (__a, __b) => if {mutant} {{ __a {new} __b }} else {{ __a {old} __b }} }})"
                    )),
                ]
            });
        } else {
            // Comparisons leave their operands where they are.
            self.switch(&e.op, e, |mutant, new| {
                vec![
                    text("(match (&("),
                    source(a),
                    text("), &("),
                    source(b),
                    text(format!(
                        ")) {{ (__a, __b) => if {mutant} {{ *__a {new} *__b }} else {{ *__a {old} *__b }} }})"
                    )),
                ]
            });
        }
    }

    fn method(&mut self, e: &syn::ExprMethodCall) {
        if e.turbofish.is_some() {
            return;
        }
        self.switch(&e.method, e, |mutant, new| {
            let arguments: Vec<String> = (0..e.args.len()).map(|i| format!("__{i}")).collect();
            let arguments = arguments.join(", ");
            let mut pieces = vec![text("(match ("), source(&*e.receiver), text(", ")];
            for argument in &e.args {
                pieces.extend([source(argument), text(", ")]);
            }
            let old = &e.method;
            pieces.push(text(format!(
                ") {{ (__a, {arguments}) => if {mutant} {{ __a.{new}({arguments}) }} else {{ __a.{old}({arguments}) }} }})"
            )));
            pieces
        });
    }

    fn call(&mut self, e: &syn::ExprCall) {
        let Expr::Path(path) = &*e.func else {
            return;
        };
        let Some(last) = path.path.segments.last() else {
            return;
        };
        let (path_at, last_at) = (path.span().byte_range(), last.ident.span().byte_range());
        let before = &self.whole[path_at.start..last_at.start];
        let old = &self.whole[path_at];
        self.switch(&last.ident, path, |mutant, new| {
            vec![text(format!(
                "(if {mutant} {{ {before}{new} }} else {{ {old} }})"
            ))]
        });
    }
}

impl<'ast> Visit<'ast> for Switches<'_> {
    fn visit_expr_binary(&mut self, e: &'ast syn::ExprBinary) {
        self.binary(e);
        visit::visit_expr_binary(self, e);
    }

    fn visit_expr_unary(&mut self, e: &'ast syn::ExprUnary) {
        if let UnOp::Neg(minus) = &e.op {
            self.switch(minus, e, |mutant, _| {
                vec![
                    text("(match "),
                    source(&*e.expr),
                    text(format!(
                        " {{ __a => if {mutant} {{ __a }} else {{ -__a }} }})"
                    )),
                ]
            });
        }
        visit::visit_expr_unary(self, e);
    }

    fn visit_expr_lit(&mut self, e: &'ast syn::ExprLit) {
        let old = &self.whole[e.lit.span().byte_range()];
        self.switch(&e.lit, e, |mutant, new| {
            vec![text(format!("(if {mutant} {{ {new} }} else {{ {old} }})"))]
        });
    }

    fn visit_expr_method_call(&mut self, e: &'ast syn::ExprMethodCall) {
        self.method(e);
        visit::visit_expr_method_call(self, e);
    }

    fn visit_expr_call(&mut self, e: &'ast syn::ExprCall) {
        self.call(e);
        visit::visit_expr_call(self, e);
    }

    fn visit_macro(&mut self, m: &'ast Macro) {
        let arguments = Punctuated::<Expr, Token![,]>::parse_terminated.parse2(m.tokens.clone());
        for argument in arguments.iter().flatten() {
            self.visit_expr(argument);
        }
    }

    fn visit_expr_repeat(&mut self, e: &'ast syn::ExprRepeat) {
        self.visit_expr(&e.expr);
    }

    fn visit_signature(&mut self, _: &'ast syn::Signature) {}

    fn visit_item_fn(&mut self, f: &'ast syn::ItemFn) {
        if f.sig.constness.is_none() {
            visit::visit_item_fn(self, f);
        }
    }

    fn visit_impl_item_fn(&mut self, f: &'ast syn::ImplItemFn) {
        if f.sig.constness.is_none() {
            visit::visit_impl_item_fn(self, f);
        }
    }

    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_path(&mut self, _: &'ast syn::Path) {}
    fn visit_generics(&mut self, _: &'ast syn::Generics) {}
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    fn visit_angle_bracketed_generic_arguments(
        &mut self,
        _: &'ast syn::AngleBracketedGenericArguments,
    ) {
    }
}

/// Adds `range` of the source with its edits, which are sorted from the outside inwards.
fn render(whole: &str, range: Range<usize>, edits: &[Edit], out: &mut String) {
    let mut at = range.start;
    for edit in edits {
        if edit.range.start < at || edit.range.end > range.end {
            continue;
        }
        out.push_str(&whole[at..edit.range.start]);
        // By these run.py finds the switch that an error of the compiler lies in.
        out.push_str(&format!("/*<{}*/", edit.number));
        for piece in &edit.pieces {
            match piece {
                Piece::Text(text) => out.push_str(text),
                Piece::Source(part) => render(whole, part.clone(), edits, out),
            }
        }
        out.push_str(&format!("/*>{}*/", edit.number));
        at = edit.range.end;
    }
    out.push_str(&whole[at..range.end]);
}

/// A line of SITES.
fn site(line: &str) -> Option<(usize, Site)> {
    let mut parts = line.split('\t');
    let number = parts.next()?.parse().ok()?;
    let at = parts.next()?.parse().ok()?;
    let new = parts.next()?.to_owned();
    Some((at, Site { number, new }))
}

fn main() -> Result<(), Box<dyn Error>> {
    let [from, sites, to] = env::args()
        .skip(1)
        .collect::<Vec<_>>()
        .try_into()
        .map_err(|_| "SOURCE SITES OUT")?;
    let whole = fs::read_to_string(from)?;
    let file = syn::parse_file(&whole)?;
    let mut switches = Switches {
        whole: &whole,
        sites: fs::read_to_string(sites)?
            .lines()
            .filter_map(site)
            .collect(),
        edits: Vec::new(),
    };
    switches.visit_file(&file);
    let mut edits = switches.edits;
    edits.sort_by_key(|edit| (edit.range.start, Reverse(edit.range.end)));
    let mut out = String::new();
    render(&whole, 0..whole.len(), &edits, &mut out);
    fs::write(to, out)?;
    for edit in &edits {
        println!("{}", edit.number);
    }
    Ok(())
}
